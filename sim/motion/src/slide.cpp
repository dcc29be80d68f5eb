#include "breakaway/motion/slide.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "breakaway/motion/constant_friction_motion.hpp"
#include "breakaway/motion/roots.hpp"
#include "breakaway/motion/tie.hpp"

namespace breakaway::motion {
namespace {

void require_finite(const char* name, double value) {
  if (!std::isfinite(value)) throw InputError{std::string(name) + " must be finite"};
}

void require_valid(const model::AppliedForce& force) {
  require_finite("force", force.constant_N + force.transient_N + force.start_s + force.stiffness_N_per_m +
                              force.damping_Ns_per_m + force.reference_m);
  if (force.transient_N != 0 && !(force.time_constant_s > 0)) {
    throw InputError{"time_constant_s must be positive"};
  }
}

int sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

// A maximum that stays above zero for less than 2^-24 of a window of the law's scale of time is passed over.
constexpr int scan_depth = 24;

// Waiting, or a closed form and what begins and ends it, in evaluations of the forces.
constexpr double work_of_a_piece = 10;

}  // namespace

Slide::Slide(double mass_kg, model::FrictionLaw friction, SlideState initial, double tolerance)
    : mass_kg_(mass_kg),
      tolerance_(tolerance),
      friction_(std::move(friction)),
      time_{initial.time_s},
      state_(initial),
      direction_(sign(initial.velocity_m_s)) {
  require_finite("time_s", initial.time_s);
  require_finite("position_m", initial.position_m);
  require_finite("velocity_m_s", initial.velocity_m_s);
  require_finite("mass_kg", mass_kg);
  if (mass_kg <= 0) throw InputError{"mass_kg must be positive"};
  if (!(tolerance >= 1e-14 && tolerance <= 1e-2)) throw InputError{"tolerance must be in [1e-14, 1e-2]"};
  friction_.on_time(initial.time_s);
  face_law();
}

StopReason Slide::advance_to(double time_s, const model::AppliedForce& force, bool stop_at_rest) {
  require_finite("time_s", time_s);
  if (time_s < state_.time_s) throw InputError{"time_s must not lie before the state's time"};
  require_valid(force);
  force_ = force;
  if (state_.velocity_m_s == 0) release_if_pushed();
  while (time_.until(time_s) > 0) {
    const double end_s = std::min(time_s, next_change_s_);
    const double duration_s = time_.until(end_s);
    const auto sticks_before = counters_.sticks;
    spend(state_.time_s, work_of_a_piece);
    if (direction_ == 0) {
      stick(duration_s, end_s);
    } else {
      slide(duration_s, end_s);
    }
    if (state_.time_s >= next_change_s_) {
      friction_.on_time(state_.time_s);
      ++counters_.law_switches;
      face_law();
    }
    if (stop_at_rest && counters_.sticks != sticks_before) return StopReason::came_to_rest;
    if (direction_ == 0) release_if_pushed();
  }
  return StopReason::reached_time;
}

void Slide::apply_impulse(double impulse_Ns) {
  require_finite("impulse_Ns", impulse_Ns);
  if (impulse_Ns == 0) return;
  state_.velocity_m_s += impulse_Ns / mass_kg_;
  since_event_s_ = 0;
  last_direction_ = 0;
  if (direction_ != 0 && state_.velocity_m_s == 0) return come_to_rest();
  if (direction_ == 0) {
    ++counters_.slips;
    friction_.on_slip(state_.time_s);
  }
  direction_ = sign(state_.velocity_m_s);
  face_law();
  observe_now();
}

double Slide::friction_force_N() const {
  if (direction_ != 0) {
    return -direction_ * friction_.level_N(state_.time_s, state_.position_m, std::abs(state_.velocity_m_s));
  }
  return -std::clamp(force_.at_N(state_.time_s, state_.position_m, 0), -rest_level_N_[0], rest_level_N_[1]);
}

void Slide::observe(double interval_s, Observer observer) {
  if (!(interval_s > 0)) throw InputError{"interval_s must be positive"};
  observer_interval_s_ = interval_s;
  observer_ = std::move(observer);
  observe_now();
}

// --- at rest

void Slide::release_if_pushed() {
  if (direction_ != 0) {  // motion began at the very end of the last call: this call's force decides
    direction_ = 0;
    face_law();
  }
  const double push_N = force_.at_N(state_.time_s, state_.position_m, 0);
  const int direction = sign(push_N);
  if (direction != 0 && std::abs(push_N) > widened(rest_level_N_[direction > 0])) slip(direction, push_N);
}

void Slide::slip(int direction, double push_N) {
  friction_.face(state_.position_m, direction);
  const double before_N = friction_.level_N(state_.time_s, state_.position_m, 0);
  friction_.on_slip(state_.time_s);
  friction_.face(state_.position_m, direction);
  const double after_N = friction_.level_N(state_.time_s, state_.position_m, 0);
  // A law that is drawn anew at the slip may hold the axis after all.
  if (after_N > before_N && std::abs(push_N) <= widened(after_N)) return face_law();
  direction_ = direction;
  ++counters_.slips;
  if (last_direction_ == -direction) ++counters_.reversals;
  last_direction_ = 0;
  since_event_s_ = 0;
  face_law();
  observe_now();
}

void Slide::stick(double duration_s, double end_s) {
  int direction = 0;
  const double wait_s = breakaway_after_s(duration_s, direction);
  if (last_direction_ != 0) since_event_s_ = 0;
  last_direction_ = 0;
  if (wait_s < duration_s) {
    pass_time(wait_s);
    slip(direction, force_.at_N(state_.time_s, state_.position_m, 0));
  } else {
    since_event_s_ += duration_s;
    set_time(end_s);
    if (friction_.varies_with_time()) face_law();
  }
  observe_now();
}

// The time until the push first exceeds the level at rest, and the direction of the motion that begins.
double Slide::breakaway_after_s(double duration_s, int& direction) {
  if (friction_.varies_with_time()) return scan_for_breakaway(duration_s, direction);
  const double transient_N = force_.transient_at_N(state_.time_s);
  if (transient_N == 0) return never;
  // The push is monotone in time: only the level on the side that it moves towards can be crossed.
  direction = transient_N > 0 ? -1 : 1;
  const double push_N = force_.at_N(state_.time_s, state_.position_m, 0);
  const double missing_N = direction * widened(rest_level_N_[direction > 0]) - push_N;
  const double fraction = missing_N / -transient_N;  // of the change still to come
  return fraction < 1 ? -force_.time_constant_s * std::log1p(-fraction) : never;
}

// This is for a level that varies smoothly in time. The law's and the push's scales of time bound how fast the excess
// of the push over the level can rise, so whole intervals are ruled out until the first crossing is enclosed.
double Slide::scan_for_breakaway(double duration_s, int& direction) {
  const auto bounds = friction_.bounds();
  double steepest_N_per_s = (bounds.upper_N - bounds.lower_N) / friction_.time_scale_s();
  double window_s = friction_.time_scale_s();
  const double transient_N = force_.transient_at_N(state_.time_s);
  // The push goes from what it is to what it is without the transient, and never back.
  const double push_N = force_.at_N(state_.time_s, state_.position_m, 0);
  const double greatest_push_N = std::max(std::abs(push_N), std::abs(push_N - transient_N));
  const double least_level_N = std::min(rest_level_N_[0], rest_level_N_[1]) - steepest_N_per_s * duration_s;
  if (greatest_push_N <= least_level_N) return never;
  if (transient_N != 0) {
    steepest_N_per_s += std::abs(transient_N) / force_.time_constant_s;
    window_s = std::min(window_s, force_.time_constant_s);
  }
  const auto excess_N = [&](double tau_s) {
    const double time_s = time_.after(tau_s);
    spend(time_s, 1);
    const double pushes_N = force_.at_N(time_s, state_.position_m, 0);
    direction = pushes_N < 0 ? -1 : 1;
    return std::abs(pushes_N) - widened(friction_.breakaway_N(time_s, state_.position_m, direction));
  };
  double start_s = 0, start_N = excess_N(0);
  while (start_s < duration_s) {
    const double end_s = std::min(start_s + window_s, duration_s);
    const double end_N = excess_N(end_s);
    const double wait_s =
        motion::first_excess(excess_N, {start_s, start_N}, {end_s, end_N}, steepest_N_per_s, scan_depth);
    if (wait_s < never) {
      excess_N(wait_s);  // leaves the direction of this instant
      return wait_s;
    }
    start_s = end_s;
    start_N = end_N;
  }
  return never;
}

// --- in motion

bool Slide::motion_is_closed_form() const {
  return friction_.constant_between_events() && !(force_.has_feedback() && force_.transient_N != 0);
}

double Slide::edge_distance_m() const {
  return direction_ > 0 ? range_m_.upper_m - state_.position_m : state_.position_m - range_m_.lower_m;
}

void Slide::slide(double duration_s, double end_s) {
  const Segment segment = motion_is_closed_form() ? slide_in_closed_form(duration_s) : slide_by_integration(duration_s);
  last_direction_ = 0;
  if (segment.ending == Ending::time) {
    since_event_s_ += duration_s;
    set_time(end_s);
  } else {
    pass_time(segment.duration_s);
  }
  state_.position_m += direction_ * segment.distance_m;
  state_.velocity_m_s = direction_ * segment.speed_m_s;
  if (segment.ending == Ending::rest) {
    come_to_rest();
  } else if (segment.ending == Ending::edge) {
    state_.position_m = direction_ > 0 ? range_m_.upper_m : range_m_.lower_m;
    ++counters_.law_switches;
    face_law();
  }
  observe_now();
}

ConstantFrictionMotion Slide::closed_form() const {
  ConstantFrictionMotion motion;
  const double constant_N = force_.constant_N - force_.stiffness_N_per_m * (state_.position_m - force_.reference_m);
  motion.speed_m_s = std::abs(state_.velocity_m_s);
  motion.acceleration_m_s2 = (direction_ * constant_N - level_N_) / mass_kg_;
  if (force_.transient_N != 0) {
    motion.transient_m_s2 = direction_ * force_.transient_at_N(state_.time_s) / mass_kg_;
    motion.time_constant_s = force_.time_constant_s;
  }
  motion.decay_per_s = force_.damping_Ns_per_m / (2 * mass_kg_);
  motion.stiffness_per_s2 = force_.stiffness_N_per_m / mass_kg_;
  return motion;
}

Slide::Segment Slide::slide_in_closed_form(double duration_s) {
  ++counters_.steps;
  const ConstantFrictionMotion motion = closed_form();
  const double rest_s = motion.first_rest_s(duration_s);
  Segment segment{std::min(rest_s, duration_s), 0, 0, rest_s <= duration_s ? Ending::rest : Ending::time};
  segment.distance_m = motion.distance_at(segment.duration_s);
  const double edge_m = edge_distance_m();
  if (segment.distance_m >= edge_m) {
    segment = {motion.time_to_distance_s(edge_m, segment.duration_s), edge_m, 0, Ending::edge};
  }
  if (segment.ending != Ending::rest) segment.speed_m_s = std::max(motion.speed_at(segment.duration_s), 0.0);
  if (observer_) {
    for (double tau_s = observer_interval_s_; tau_s < segment.duration_s; tau_s += observer_interval_s_) {
      observe_at(tau_s, motion.distance_at(tau_s), motion.speed_at(tau_s));
    }
  }
  return segment;
}

void Slide::come_to_rest() {
  state_.velocity_m_s = 0;
  last_direction_ = direction_;
  direction_ = 0;
  ++counters_.sticks;
  friction_.on_stick(state_.time_s);
  face_law();
}

// --- bookkeeping

void Slide::pass_time(double duration_s) {
  since_event_s_ += duration_s;
  time_.pass(duration_s);
  state_.time_s = time_.sum_s;
}

void Slide::set_time(double time_s) {
  time_ = {time_s};
  state_.time_s = time_s;
}

void Slide::face_law() {
  if (direction_ == 0) {
    for (const int direction : {-1, 1}) {
      rest_level_N_[direction > 0] = friction_.breakaway_N(state_.time_s, state_.position_m, direction);
    }
  }
  friction_.face(state_.position_m, direction_);
  next_change_s_ = friction_.next_time_change_s();
  range_m_ = friction_.range_m();
  level_N_ = friction_.level_N(state_.time_s, state_.position_m, std::abs(state_.velocity_m_s));
}

void Slide::observe_now() const {
  if (observer_) observe_at(0, 0, std::abs(state_.velocity_m_s));
}

// Reports the state that lies this far ahead in the present motion.
void Slide::observe_at(double tau_s, double distance_m, double speed_m_s) const {
  const SlideState state{time_.after(tau_s), state_.position_m + direction_ * distance_m, direction_ * speed_m_s};
  observer_(state, friction_.level_N(state.time_s, state.position_m, speed_m_s));
}

}  // namespace breakaway::motion
