// Motion that has no closed form: friction that varies with velocity, position or time, or feedback beside a transient.
#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/motion/gragg_bulirsch_stoer.hpp"
#include "breakaway/motion/henon.hpp"
#include "breakaway/motion/slide.hpp"

namespace breakaway::motion {
namespace {

using motion::Vector;

// The tolerance for the part of a motion that friction takes, in units of that for a whole one; the row that is taken
// is closer by orders of magnitude.
constexpr double part_tolerance = 10;
constexpr double rounding = 1e-14;  // of a sum of forces
// After so many refused steps in a row a motion that neither stops nor clearly goes on is at rest, to rounding.
constexpr int max_refusals = 60;

constexpr std::size_t distance = 0, speed = 1;

// Motion under a held force and the transient that leads to it, without friction, in travel coordinates.
class PushedMotion {
 public:
  struct State {
    double distance_m, speed_m_s, acceleration_m_s2;
  };

  // transient_m_s2: at the start.
  PushedMotion(double start_speed_m_s, double constant_m_s2, double transient_m_s2, double time_constant_s)
      : start_speed_m_s_(start_speed_m_s),
        constant_m_s2_(constant_m_s2),
        transient_m_s2_(transient_m_s2),
        time_constant_s_(time_constant_s) {}

  State at(double tau_s) {
    const double gain_m_s = constant_m_s2_ * tau_s;
    State state{tau_s * (start_speed_m_s_ + 0.5 * gain_m_s), start_speed_m_s_ + gain_m_s, constant_m_s2_};
    if (transient_m_s2_ == 0) return state;
    const double gone = share_gone(tau_s), settled_m_s = transient_m_s2_ * time_constant_s_;
    state.distance_m += settled_m_s * (tau_s - time_constant_s_ * gone);
    state.speed_m_s += settled_m_s * gone;
    state.acceleration_m_s2 += transient_m_s2_ * (1 - gone);
    return state;
  }

 private:
  // 1 - e^(-tau / time constant). An integrator asks at equal distances, so that one exponential serves a whole row:
  // what is left falls by the same share in each.
  double share_gone(double tau_s) {
    const double next_s = last_s_ + spacing_s_;
    if (std::abs(tau_s - next_s) <= 4 * std::numeric_limits<double>::epsilon() * tau_s) {
      gone_ += gone_in_spacing_ * (1 - gone_);
    } else {
      gone_ = gone_in_spacing_ = -std::expm1(-tau_s / time_constant_s_);
      spacing_s_ = tau_s;
    }
    last_s_ = tau_s;
    return gone_;
  }

  double start_speed_m_s_;
  double constant_m_s2_;
  double transient_m_s2_;
  double time_constant_s_;
  double last_s_ = 0, spacing_s_ = 0;
  double gone_ = 0, gone_in_spacing_ = 0;
};

// Eq. (7) in travel coordinates (distance and speed along the motion, time since its start), remembering the range of
// the accelerations that it was asked for: it screens a step for interior extrema of the speed.
class TravelEquation {
 public:
  TravelEquation(const model::FrictionLaw& friction, const model::AppliedForce& force, const SlideState& start,
                 const SummedTime& time, int direction, double mass_kg)
      : friction_(friction),
        force_(force),
        start_(start),
        time_(time),
        direction_(direction),
        mass_kg_(mass_kg),
        offset_m_(start.position_m - force.reference_m),
        transient_N_(force.transient_at_N(start.time_s)) {
    const auto bounds = friction.bounds();
    const double force_N = std::abs(force.constant_N) + std::abs(force.stiffness_N_per_m * offset_m_) +
                           std::abs(force.damping_Ns_per_m * start.velocity_m_s) + std::abs(transient_N_);
    const double time_rounding_s = std::numeric_limits<double>::epsilon() * std::abs(start.time_s);
    double steepest_N_per_s = (bounds.upper_N - bounds.lower_N) / friction.time_scale_s();
    if (transient_N_ != 0) steepest_N_per_s += std::abs(transient_N_) / force.time_constant_s;
    resolution_m_s2_ = (rounding * (force_N + bounds.upper_N) + steepest_N_per_s * time_rounding_s) / mass_kg;
    greatest_acceleration_m_s2_ = (force_N + bounds.upper_N) / mass_kg;
  }

  // Rounding leaves an acceleration uncertain by this, because of the forces that it is the difference of, and of time
  // in the friction law and in the transient.
  double resolution_m_s2() const { return resolution_m_s2_; }

  double acceleration(double tau_s, double distance_m, double speed_m_s) const {
    const double moved_m = direction_ * distance_m;
    double force_N = force_.constant_N - force_.stiffness_N_per_m * (offset_m_ + moved_m) -
                     force_.damping_Ns_per_m * direction_ * speed_m_s;
    if (transient_N_ != 0) force_N += transient_N_ * std::exp(-tau_s / force_.time_constant_s);
    return direction_ * force_N / mass_kg_ - friction_m_s2(tau_s, distance_m, speed_m_s);
  }

  void operator()(double tau_s, const Vector<2>& y, Vector<2>& derivative) {
    derivative = {y[speed], acceleration(tau_s, y[distance], y[speed])};
    note_acceleration(derivative[speed]);
  }

  // Says whether no feedback acts, and the forces change the speed by little more than itself in so long a step and
  // while the transient lasts: then no two terms of the motion without friction cancel.
  bool changes_little(double speed_m_s, double step_s) const {
    const double transient_s = transient_N_ == 0 ? 0 : force_.time_constant_s;
    return !force_.has_feedback() && std::max(step_s, transient_s) * greatest_acceleration_m_s2_ <= 8 * speed_m_s;
  }
  PushedMotion without_friction(double tau_s, double speed_m_s) const {
    const double transient_N = transient_N_ == 0 ? 0 : transient_N_ * std::exp(-tau_s / force_.time_constant_s);
    return {speed_m_s, direction_ * force_.constant_N / mass_kg_, direction_ * transient_N / mass_kg_,
            force_.time_constant_s};
  }
  double friction_m_s2(double tau_s, double distance_m, double speed_m_s) const {
    return friction_.level_N(time_.after(tau_s), start_.position_m + direction_ * distance_m, speed_m_s) / mass_kg_;
  }

  void note_acceleration(double acceleration_m_s2) {
    ++evaluations_;
    least_ = std::min(least_, acceleration_m_s2);
    greatest_ = std::max(greatest_, acceleration_m_s2);
  }

  void forget_range() {
    least_ = std::numeric_limits<double>::infinity();
    greatest_ = -least_;
  }
  double evaluations() const { return evaluations_; }
  double least() const { return least_; }
  double greatest() const { return greatest_; }

 private:
  const model::FrictionLaw& friction_;
  const model::AppliedForce& force_;
  const SlideState& start_;
  SummedTime time_;
  int direction_;
  double mass_kg_;
  double offset_m_;
  double transient_N_;
  double resolution_m_s2_;
  double greatest_acceleration_m_s2_;
  double evaluations_ = 0;
  double least_ = 0;
  double greatest_ = 0;
};

struct Trial {
  bool converged;
  double tau_s;
  Vector<2> y;
  double suggested_s;
};

// Takes a step in time.
Trial trial_step(TravelEquation& equation, double tau_s, const Vector<2>& y, double step_s, double tolerance) {
  const double speed_floor = equation.resolution_m_s2() * step_s;
  equation.forget_range();
  const auto step =
      motion::extrapolated_step(equation, tau_s, y, step_s, tolerance, {speed_floor * step_s, speed_floor});
  return {step.converged, tau_s + step_s, step.state, step.suggested_step};
}

// What friction takes from the motion that the pushing force alone would make, which is known in closed form. A current
// loop's transient is far shorter than what friction notices of it, so that much longer steps converge.
class FrictionPart {
 public:
  FrictionPart(TravelEquation& equation, double tau_s, const Vector<2>& y)
      : equation_(equation), pushed_(equation.without_friction(tau_s, y[speed])), tau_s_(tau_s), y_(y) {}

  void operator()(double step_s, const Vector<2>& part, Vector<2>& derivative) {
    const auto pushed = pushed_.at(step_s);
    const double taken = equation_.friction_m_s2(tau_s_ + step_s, y_[distance] + pushed.distance_m + part[distance],
                                                 pushed.speed_m_s + part[speed]);
    equation_.note_acceleration(pushed.acceleration_m_s2 - taken);
    derivative = {part[speed], -taken};
  }

  // The whole motion.
  Vector<2> with_push(double step_s, const Vector<2>& part) {
    const auto pushed = pushed_.at(step_s);
    return {y_[distance] + pushed.distance_m + part[distance], pushed.speed_m_s + part[speed]};
  }

 private:
  TravelEquation& equation_;
  PushedMotion pushed_;
  double tau_s_;
  Vector<2> y_;
};

// Takes a step in time of a motion that is much faster than what the forces change in it, so that nothing cancels
// between the two parts.
Trial trial_step_of_friction(TravelEquation& equation, double tau_s, const Vector<2>& y, double step_s,
                             double tolerance) {
  const double speed_floor = equation.resolution_m_s2() * step_s + tolerance * y[speed];
  const double distance_floor = speed_floor * step_s + tolerance * y[distance];
  FrictionPart part(equation, tau_s, y);
  equation.forget_range();
  const auto step =
      motion::extrapolated_step(part, 0, Vector<2>{}, step_s, tolerance, {0.5 * distance_floor, speed_floor});
  return {step.converged, tau_s + step_s, part.with_push(step_s, step.state), step.suggested_step};
}

// Takes a step to exactly y[E] = target, by exchange of the independent variable.
template <std::size_t E>
Trial trial_to(TravelEquation& equation, double tau_s, const Vector<2>& y, double target, double tolerance) {
  const double rate = E == speed ? equation.acceleration(tau_s, y[distance], y[speed]) : y[speed];
  const double step_s = (target - y[E]) / rate;
  const double speed_floor = equation.resolution_m_s2() * step_s;
  const double tau_floor = speed_floor / std::abs(rate) * (E == speed ? 1 : step_s);
  const Vector<2> floor = E == speed ? Vector<2>{tau_floor * y[speed], tau_floor} : Vector<2>{tau_floor, speed_floor};
  motion::Exchanged<2, E, TravelEquation> exchanged(equation);
  Vector<2> z = y;
  z[E] = tau_s;
  equation.forget_range();
  const auto step = motion::extrapolated_step(exchanged, y[E], z, target - y[E], tolerance, floor);
  Vector<2> end = step.state;
  end[E] = target;
  return {step.converged, step.state[E], end, step.suggested_step / rate};
}

// Flight follows one motion from its start until the duration is over, the law's edge is reached, or it comes to rest,
// and chooses the variable of each step. A refused step only changes the step that is tried next.
class Flight {
 public:
  enum class State { goes_on, over, at_edge, at_rest };

  Flight(TravelEquation equation, double speed_m_s, double duration_s, double edge_m, double longest_s,
         double tolerance)
      : equation_(equation),
        y_{0, speed_m_s},
        duration_s_(duration_s),
        edge_m_(edge_m),
        longest_s_(longest_s),
        tolerance_(tolerance) {}

  // Tries one step of at most step_s, which it replaces by the step to try next. True if the flight moved on.
  bool advance(double& step_s) {
    const double step = std::min({step_s, longest_s_, duration_s_ - tau_s_});
    const double acceleration = equation_.acceleration(tau_s_, y_[distance], y_[speed]);
    const bool near_rest = y_[speed] > 0 && y_[speed] + 2 * step * acceleration <= 0;
    return near_rest && !outlasts_ ? advance_in_speed(acceleration, step_s) : advance_in_time(step, step_s);
  }

  State state() const { return state_; }
  double tau_s() const { return tau_s_; }
  double evaluations() const { return equation_.evaluations(); }  // of the forces
  double distance_m() const { return y_[distance]; }
  double speed_m_s() const { return y_[speed]; }

 private:
  bool advance_in_speed(double acceleration, double& step_s) {
    const double drop_m_s = std::min(y_[speed], -acceleration * longest_s_);
    const Trial trial = trial_to<speed>(equation_, tau_s_, y_, y_[speed] - drop_m_s, tolerance_);
    if (!trial.converged || equation_.greatest() >= 0) {  // too far, or the speed may have a minimum ahead
      step_s = std::min(0.25 * y_[speed] / -acceleration, trial.suggested_s);
      return false;
    }
    if (trial.y[distance] >= edge_m_) {
      step_s = 0.25 * y_[speed] / -acceleration;
      return advance_to_edge(step_s);
    }
    if (trial.tau_s > duration_s_) {
      outlasts_ = true;
      return false;
    }
    accept(trial, y_[speed] == drop_m_s ? State::at_rest : State::goes_on);
    return true;
  }

  bool advance_in_time(double step, double& step_s) {
    const Trial trial = equation_.changes_little(y_[speed], step)
                            ? trial_step_of_friction(equation_, tau_s_, y_, step, part_tolerance * tolerance_)
                            : trial_step(equation_, tau_s_, y_, step, tolerance_);
    // A rising push that breaks the axis away may lie below friction by rounding when motion begins: that is no rest.
    const double least = equation_.least();
    const bool brakes = least < -equation_.resolution_m_s2();
    const bool may_rest = !outlasts_ && brakes && y_[speed] + step * least <= 0;
    if (!trial.converged || may_rest || trial.y[speed] <= 0) {
      step_s = trial.converged ? 0.5 * step : std::min(trial.suggested_s, 0.7 * step);
      return false;
    }
    if (trial.y[distance] >= edge_m_) {
      step_s = step;
      return advance_to_edge(step_s);
    }
    const bool cut_short = step < step_s;
    step_s = cut_short ? std::max(step_s, trial.suggested_s) : trial.suggested_s;
    accept(trial, step == duration_s_ - tau_s_ ? State::over : State::goes_on);
    return true;
  }

  bool advance_to_edge(double& step_s) {
    if (y_[speed] > 0) {
      const Trial trial = trial_to<distance>(equation_, tau_s_, y_, edge_m_, tolerance_);
      if (trial.converged) {
        accept(trial, State::at_edge);
        return true;
      }
    }
    step_s *= 0.5;  // from rest, or not far enough in one step: go nearer first
    return false;
  }

  void accept(const Trial& trial, State state) {
    tau_s_ = trial.tau_s;
    y_ = trial.y;
    state_ = state;
  }

  TravelEquation equation_;
  Vector<2> y_;
  double tau_s_ = 0;
  double duration_s_;
  double edge_m_;
  double longest_s_;
  double tolerance_;
  bool outlasts_ = false;  // known not to come to rest within the duration
  State state_ = State::goes_on;
};

}  // namespace

Slide::Segment Slide::slide_by_integration(double duration_s) {
  const TravelEquation equation(friction_, force_, state_, time_, direction_, mass_kg_);
  const double longest_s = observer_ ? std::min(duration_s, observer_interval_s_) : duration_s;
  Flight flight(equation, std::abs(state_.velocity_m_s), duration_s, edge_distance_m(), longest_s, tolerance_);
  double step_s = next_step_s_ > 0 ? next_step_s_ : first_step_s(duration_s);
  for (int refusals = 0; flight.state() == Flight::State::goes_on; ++refusals) {
    if (refusals == max_refusals) return {flight.tau_s(), flight.distance_m(), 0, Ending::rest};
    const double before = flight.evaluations();
    const bool moved = flight.advance(step_s);
    spend(state_.time_s + flight.tau_s(), flight.evaluations() - before);
    if (!moved) continue;
    refusals = 0;
    ++counters_.steps;
    if (observer_ && flight.state() == Flight::State::goes_on) {
      observe_at(flight.tau_s(), flight.distance_m(), flight.speed_m_s());
    }
  }
  next_step_s_ = step_s;
  const Ending ending = flight.state() == Flight::State::over      ? Ending::time
                        : flight.state() == Flight::State::at_edge ? Ending::edge
                                                                   : Ending::rest;
  return {flight.tau_s(), flight.distance_m(), flight.speed_m_s(), ending};
}

// The shortest of the scenario's own scales of time.
double Slide::first_step_s(double duration_s) const {
  double step_s = std::min(duration_s, friction_.time_scale_s());
  if (force_.stiffness_N_per_m > 0) step_s = std::min(step_s, std::sqrt(mass_kg_ / force_.stiffness_N_per_m));
  if (force_.damping_Ns_per_m > 0) step_s = std::min(step_s, mass_kg_ / force_.damping_Ns_per_m);
  if (force_.transient_N != 0) step_s = std::min(step_s, force_.time_constant_s);
  return step_s;
}

}  // namespace breakaway::motion
