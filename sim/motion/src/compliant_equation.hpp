// The smooth pieces of a CompliantPlant's motion: its equations while nothing sticks, slips, meets or turns round, and
// the functions whose zeros end a piece.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

#include "breakaway/model/applied_force.hpp"
#include "breakaway/model/compliant_plant.hpp"
#include "breakaway/motion/gragg_bulirsch_stoer.hpp"
#include "breakaway/motion/linearly_implicit.hpp"

namespace breakaway::motion {

// The state: the motor's position and velocity, the deflection motor - load, the load's velocity, the bristles' bend.
inline constexpr std::size_t position = 0, velocity = 1, deflection = 2, load_velocity = 3, bend = 4, components = 5;
using CompliantVector = Vector<components>;

// A dry contact: friction under a mass, as the law's present piece says it.
struct DryContact {
  mutable std::optional<model::FrictionLaw> law{};  // none: the mass moves freely; to ask for its level is to face it
  int direction = 0;                                // of motion; 0: it sticks
  double rest_level_N[2] = {0, 0};                  // to break away in the negative, positive direction
  double next_change_s = std::numeric_limits<double>::infinity();
  model::PositionRange range_m{};

  bool sticks() const { return law && direction == 0; }
};

struct CompliantPiece {
  DryContact motor, load;
  int side = 0;           // of the backlash where the teeth meet; 0: in the gap
  bool pressing = false;  // and whether they press
  bool damped = true;     // bristles that bend less than their level bears; see model/presliding.hpp
};

// What may end a piece.
enum class PieceEnd : std::size_t { motor, load, damping, teeth, press, motor_edge, load_edge, count };
inline constexpr std::size_t piece_ends = static_cast<std::size_t>(PieceEnd::count);

class CompliantEquation {
 public:
  // Everything must outlive it. time_s is that of the start, which its own time is counted from.
  CompliantEquation(const model::CompliantPlant& plant, const CompliantPiece& piece, const model::AppliedForce& force,
                    double time_s);

  // The right-hand side. It notes whether the piece ended inside the step's finest subdivision.
  void operator()(double tau_s, const CompliantVector& y, CompliantVector& derivative);
  bool ended_inside() const { return ended_inside_; }
  double evaluations() const { return evaluations_; }  // of the right-hand side
  // The stages of a linearly implicit step are of first order, far too coarse for the slack of bristles in sliding,
  // which is nearly none. It is left out of what operator() notes, and looked for by the cubic between the two ends.
  void watch_coarsely() { coarse_ = true; }
  bool slack_fails_between(const CompliantVector& from, const CompliantVector& to, double step_s);
  std::span<const PieceEnd> watched() const { return {watched_.data(), watched_count_}; }

  Matrix<components> jacobian(double tau_s, const CompliantVector& y) const;
  // The rate of the fastest part that only relaxes.
  double relaxation_per_s(double tau_s, const CompliantVector& y) const;

  // Without friction.
  double push_on_motor_N(double tau_s, const CompliantVector& y) const;
  double push_on_load_N(const CompliantVector& y) const { return coupling_N(y); }
  double coupling_N(const CompliantVector& y) const;
  double motor_level_N(double tau_s, const CompliantVector& y) const;
  // 1 - s u of model/presliding.hpp: the share of the bend that is still to come.
  double slack(double tau_s, const CompliantVector& y) const;
  // On the motor, against motion in its positive direction.
  double friction_N(double tau_s, const CompliantVector& y) const;

  // Below zero where the piece has ended for this reason, which must be one of watched().
  double margin(PieceEnd end, double tau_s, const CompliantVector& y) const;

  // Bristles turn round with the velocity. Below this speed it is not asked which way: their bend changes by 1e-9 of
  // its greatest until they turn.
  double slowest_m_s(double level_N) const;

 private:
  double drive_N(double tau_s) const;
  double slope_of_level_per_m(double tau_s, const CompliantVector& y, double level_N) const;
  double load_level_N(double tau_s, const CompliantVector& y) const;
  bool may_come(PieceEnd end) const;
  static double edge_margin_m(const DryContact& contact, double place_m);
  double rest_margin_N(const DryContact& contact, double push_N, double tau_s, double place_m) const;
  bool meshed() const { return plant_.load->coupling.gap_m == 0 || (piece_.side != 0 && piece_.pressing); }

  // The right-hand side and the margins ask for one level several times.
  struct Asked {
    double tau_s, position_m, velocity_m_s;
    bool operator==(const Asked&) const = default;
  };

  const model::CompliantPlant& plant_;
  const CompliantPiece& piece_;
  const model::AppliedForce& force_;
  double time_s_;
  double transient_N_;
  std::array<PieceEnd, piece_ends> watched_{};  // those that may come
  std::size_t watched_count_ = 0;
  double asked_s_ = std::numeric_limits<double>::infinity();
  double evaluations_ = 0;
  bool ended_inside_ = false;
  bool coarse_ = false;
  mutable Asked asked_level_{-1, 0, 0};
  mutable double level_N_ = 0;
};

}  // namespace breakaway::motion
