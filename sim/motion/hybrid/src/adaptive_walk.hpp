// AdaptiveWalk holds what Adaptive knows on its way: the state at the last step, and which directions stick.
#pragma once

#include <functional>
#include <vector>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/mode_choice.hpp"
#include "breakaway/hybrid/stick_set.hpp"
#include "breakaway/motion/summed_time.hpp"

namespace breakaway::hybrid {

// The motions that are left while some directions stick, q' = basis u with basis^T M basis = 1, and the limits of what
// static friction can bear.
struct HeldSet {
  DirectionSet sticking;       // with all that cannot slide while these stick
  Eigen::MatrixXd basis;       // n x k
  Eigen::MatrixXd to_reduced;  // u = to_reduced q'
  Eigen::MatrixXd sliding;     // g = sliding u
  std::vector<Facet<Eigen::Dynamic, Eigen::Dynamic>> facets;

  Eigen::Index motions() const { return basis.cols(); }
};

HeldSet make_held_set(const LinearMachine<>& machine, DirectionSet sticking);

// A static limit: one of the two sides of a facet.
struct Limit {
  std::size_t facet;
  int side;  // -1, +1
};

struct AdaptiveWalk {
  using Vector = Eigen::VectorXd;

  const LinearMachine<>& machine;
  const ModeChoice& choice;
  Adaptive::Laws& laws;
  std::function<const HeldSet&(DirectionSet)> held_set;

  Vector q, v;
  motion::SummedTime time;
  std::vector<int> signs;  // of sliding; 0 while sticking
  Vector shift_m;          // position in the law = w_i^T q + shift_m: what rounding lacks at an edge
  const HeldSet* held = nullptr;
  double step_s = 0;  // suggested for the next step

  double position_m(Eigen::Index i) const { return machine.directions.col(i).dot(q) + shift_m[i]; }
  bool all_stick() const;
  double next_change_s() const;

  // The sum of all forces but those of sticking directions and of inertia, at the present place and tau_s later. The
  // direction `exchanged`, if it is not -1, slides at exactly speed_m_s.
  Vector force(double tau_s = 0, Eigen::Index exchanged = -1, double speed_m_s = 0) const;
  // The part of it that neither springs nor dampers make.
  Vector applied(double tau_s = 0, Eigen::Index exchanged = -1, double speed_m_s = 0) const;
  // The rounding of this sum at the present place, by coordinate.
  Vector force_rounding() const;
  // Returns what static friction bears beyond this force at time_s, which is negative once it gives way. With
  // `for_ever` it is what friction bears whatever the laws do with time.
  double margin_N(Limit limit, const Vector& force, double time_s, bool for_ever = false);
  // Says whether static friction bears what the sticking directions need.
  bool holds(bool for_ever = false);

  // Decides which of the stopped directions stick and which slide, and how, and tells the laws.
  void choose_mode(DirectionSet stopped);
  // A limit is exceeded: its directions slide.
  void give_way(Limit limit);

 private:
  void face_laws();
  DirectionSet release(DirectionSet stopped, DirectionSet told);
  DirectionSet slide(const ModeChoice::Stop& stop, const Sliding& sliding, DirectionSet except);
  void ask_for_levels(ModeChoice::Stop& stop, DirectionSet told);
};

}  // namespace breakaway::hybrid
