// CompliantAxis::Motion: the axis from piece to piece. Its steps are in compliant_steps.cpp, where its pieces end in
// compliant_ends.cpp, and dry friction in compliant_contacts.cpp.
#pragma once

#include <limits>
#include <optional>

#include "breakaway/motion/compliant_axis.hpp"
#include "compliant_equation.hpp"

namespace breakaway::motion {

inline int sign_of(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

class CompliantAxis::Motion {
 public:
  Motion(model::CompliantPlant plant, model::FrictionLaw friction, const SlideState& initial, double tolerance);

  void advance_to(double time_s, const model::AppliedForce& force);
  CompliantState state() const;
  bool sticking() const;
  double friction_force_N() const;
  double energy_J() const;
  const CompliantCounters& counters() const { return counters_; }
  void limit_work(WorkBudget* budget) { budget_ = budget; }

 private:
  // So many pieces may end at one instant before it is left, and as many again before the motion is refused.
  static constexpr int most_at_once = 100;

  struct Trial {
    ExtrapolatedStep<CompliantVector> step;
    bool ended_inside = false;
    double evaluations = 0;  // of the right-hand side
  };

  bool bristles() const { return plant_.presliding.has_value(); }
  double load_place_m() const { return y_[position] - y_[deflection]; }
  CompliantEquation equation() const { return {plant_, piece_, force_, time_.sum_s}; }

  void move(double duration_s, double end_s);
  double longest_step_s(double duration_s) const;
  double speed_scale_m_s(CompliantEquation& equation, double step_s) const;
  double forces_N() const;
  double rounding_N() const;
  double rounding_of_law_N(const DryContact& contact, double place_m) const;
  CompliantVector floor(double scale_m_s, double tolerance, double step_s) const;
  bool pays_to_be_implicit(double step_s) const;
  Trial try_step(double step_s, bool implicit);
  Trial step_by(double step_s, bool implicit) const;
  void accept(const CompliantVector& y, double step_s, std::optional<double> end_s);
  std::optional<PieceEnd> first_end(const CompliantVector& y, double step_s) const;
  void go_to_end(PieceEnd end, double step_s, bool implicit);
  double resolution(PieceEnd end, double step_s) const;
  void leave_instant(double end_s);

  void end_piece(PieceEnd end);
  void stop_motor();
  void stop_load();
  void turn_bristles();
  void meet_or_part();
  void release(DryContact& contact, double push_N, double place_m, bool is_motor);
  void face_pushed_bristles(double push_N);
  void release_what_is_pushed();
  void face(DryContact& contact, double place_m);
  void pass_edge(DryContact& contact);
  void change_laws();

  model::CompliantPlant plant_;
  CompliantPiece piece_;
  CompliantVector y_{};
  SummedTime time_;
  double tolerance_;
  model::AppliedForce force_;
  // What each method suggests to try next.
  double explicit_step_s_ = std::numeric_limits<double>::max();
  double implicit_step_s_ = std::numeric_limits<double>::max();
  int at_once_ = 0;  // pieces that ended without time passing
  bool held_ = false;
  CompliantCounters counters_;
  WorkBudget* budget_ = nullptr;  // none: unlimited
};

}  // namespace breakaway::motion
