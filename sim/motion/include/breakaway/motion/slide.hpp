// Slide: a mass with dry friction, pushed by a finite force and by impulses: eqs. (1)-(3), (7) and (8) of van de Wouw &
// Leine (impulsive control with uncertain friction). Positive force pushes towards positive position.
//
// Event-driven. Between events (rest, break-away, a jump of the friction law) the motion is the closed form of
// ConstantFrictionMotion where the friction level is constant, else Gragg-Bulirsch-Stoer extrapolation; rest and the
// law's position edges are met by Henon's exchange of the independent variable. There is no absolute tolerance: scaling
// positions, velocities and forces by a power of two scales every result exactly.
//
// Time and displacement are counted from the last event, so a flight of 1e-30 m that lasts 1e-15 s has the same
// relative accuracy as one of a metre.
#pragma once

#include <cstdint>
#include <functional>

#include "breakaway/input/input_error.hpp"
#include "breakaway/model/applied_force.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/motion/constant_friction_motion.hpp"
#include "breakaway/motion/summed_time.hpp"
#include "breakaway/motion/work_budget.hpp"

namespace breakaway::motion {

struct SlideState {
  double time_s = 0;
  double position_m = 0;
  double velocity_m_s = 0;
};

enum class StopReason { reached_time, came_to_rest };

struct SlideCounters {
  std::uint64_t sticks = 0;        // times that the velocity became zero
  std::uint64_t slips = 0;         // times that motion began, by force or by impulse
  std::uint64_t reversals = 0;     // slips in the opposite direction at the very instant of a stick
  std::uint64_t law_switches = 0;  // jumps of the friction law in time or position
  std::uint64_t steps = 0;         // closed-form segments and accepted integration steps
};

class Slide {
 public:
  // Called with the state and the friction force level in N; see observe().
  using Observer = std::function<void(const SlideState&, double friction_level_N)>;

  // Of an integration step, relative; for the row before the one that is taken.
  static constexpr double usual_tolerance = 1e-13;

  // `tolerance` matters only to motion that has no closed form. Throws InputError unless mass_kg > 0, tolerance is in
  // [1e-14, 1e-2] and all numbers are finite.
  Slide(double mass_kg, model::FrictionLaw friction, SlideState initial, double tolerance = usual_tolerance);

  // Moves on to exactly time_s, or with stop_at_rest to the first instant at which the velocity becomes zero after
  // motion, if that is earlier: any such instant, whether the axis then sticks, turns round or would be kicked. A next
  // call decides by its own force whether the axis stays. Throws InputError for a time_s that is not finite
  // or in the past.
  StopReason advance_to(double time_s, const model::AppliedForce& force, bool stop_at_rest = false);

  // From now on all work is taken from this budget, whose time is the state's; none: unlimited. It must outlive the
  // slide. advance_to() then throws OverBudget, too.
  void limit_work(WorkBudget* budget) { budget_ = budget; }

  // Makes the velocity jump (8), impulse / mass. Throws InputError unless finite.
  void apply_impulse(double impulse_Ns);

  const SlideState& state() const { return state_; }
  bool sticking() const { return direction_ == 0; }
  // Returns the friction on the mass under the force of the last advance_to(). At rest it balances that force, up to
  // the level at rest.
  double friction_force_N() const;
  double mass_kg() const { return mass_kg_; }
  // Returns the time since the last stick, slip or impulse, accurate where the difference of two values of time_s is
  // not. At an instant of rest it is the duration of the motion that ended.
  double time_since_event_s() const { return since_event_s_; }
  const SlideCounters& counters() const { return counters_; }

  // Calls the observer at events and at least every interval_s (> 0) of motion in between. Integration steps are
  // limited to the interval, which changes results in their last digits only.
  void observe(double interval_s, Observer observer);

 private:
  enum class Ending { time, edge, rest };
  struct Segment {
    double duration_s;
    double distance_m;
    double speed_m_s;
    Ending ending;
  };

  double edge_distance_m() const;
  bool motion_is_closed_form() const;

  void stick(double duration_s, double end_s);
  double breakaway_after_s(double duration_s, int& direction);
  double scan_for_breakaway(double duration_s, int& direction);
  void slide(double duration_s, double end_s);
  ConstantFrictionMotion closed_form() const;
  Segment slide_in_closed_form(double duration_s);
  Segment slide_by_integration(double duration_s);
  double first_step_s(double duration_s) const;

  void spend(double time_s, double work) const {
    if (budget_ != nullptr) budget_->spend(time_s, work);
  }
  void pass_time(double duration_s);
  void set_time(double time_s);
  void come_to_rest();
  void release_if_pushed();
  void slip(int direction, double push_N);
  void face_law();
  void observe_now() const;
  void observe_at(double tau_s, double distance_m, double speed_m_s) const;

  double mass_kg_;
  double tolerance_;
  model::FrictionLaw friction_;
  SummedTime time_;
  SlideState state_;  // at time_.sum_s
  model::AppliedForce force_;
  int direction_ = 0;       // of motion; 0 at rest
  int last_direction_ = 0;  // of the motion that ended at this very instant; 0 if there was none
  double since_event_s_ = 0;
  double next_step_s_ = 0;  // the integrator's suggestion; 0 before the first step
  SlideCounters counters_;

  // These are what the friction law's current piece says.
  double level_N_ = 0;               // where it is constant between events
  double rest_level_N_[2] = {0, 0};  // to break away in the negative, positive direction
  double next_change_s_ = 0;
  model::PositionRange range_m_;

  WorkBudget* budget_ = nullptr;
  double observer_interval_s_ = 0;
  Observer observer_;
};

}  // namespace breakaway::motion
