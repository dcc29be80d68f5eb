// Motion that has no closed form: friction that varies with velocity, position or time, or feedback beside a transient.
#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/integrators/gragg_bulirsch_stoer.hpp"
#include "breakaway/integrators/henon.hpp"
#include "breakaway/plant/slide.hpp"

namespace breakaway::plant {
namespace {

using integrators::Vector;

constexpr double tolerance = 1e-14;
// Halvings of a step after which a motion that neither stops nor clearly goes on is at rest to rounding.
constexpr int max_halvings = 60;

constexpr std::size_t distance = 0, speed = 1;

// Eq. (7) in travel coordinates (distance and speed along the motion, time since its start), remembering the range of
// the accelerations that it was asked for: it screens a step for interior extrema of the speed.
class TravelEquation {
 public:
  TravelEquation(const friction::FrictionLaw& friction, const AppliedForce& force, const SlideState& start,
                 double time_rest_s, int direction, double mass_kg)
      : friction_(friction),
        force_(force),
        start_(start),
        time_rest_s_(time_rest_s),
        direction_(direction),
        mass_kg_(mass_kg),
        offset_m_(start.position_m - force.reference_m),
        transient_N_(force.transient_at_N(start.time_s)) {}

  double acceleration(double tau_s, double distance_m, double speed_m_s) const {
    const double moved_m = direction_ * distance_m;
    double force_N = force_.constant_N - force_.stiffness_N_per_m * (offset_m_ + moved_m) -
                     force_.damping_Ns_per_m * direction_ * speed_m_s;
    if (transient_N_ != 0) force_N += transient_N_ * std::exp(-tau_s / force_.time_constant_s);
    const double level_N =
        friction_.level_N(start_.time_s + (time_rest_s_ + tau_s), start_.position_m + moved_m, speed_m_s);
    return (direction_ * force_N - level_N) / mass_kg_;
  }

  void operator()(double tau_s, const Vector<2>& y, Vector<2>& derivative) {
    derivative = {y[speed], acceleration(tau_s, y[distance], y[speed])};
    least_ = std::min(least_, derivative[speed]);
    greatest_ = std::max(greatest_, derivative[speed]);
  }

  void forget_range() {
    least_ = std::numeric_limits<double>::infinity();
    greatest_ = -least_;
  }
  double least() const { return least_; }
  double greatest() const { return greatest_; }

 private:
  const friction::FrictionLaw& friction_;
  const AppliedForce& force_;
  const SlideState& start_;
  double time_rest_s_;
  int direction_;
  double mass_kg_;
  double offset_m_;
  double transient_N_;
  double least_ = 0;
  double greatest_ = 0;
};

// From (tau, y) to exactly y[E] = target by exchange of the independent variable; false if it is not reached in one
// step.
template <std::size_t E>
bool step_to(TravelEquation& equation, double target, double& tau, Vector<2>& y, double& suggested_step) {
  integrators::Exchanged<2, E, TravelEquation> exchanged(equation);
  double s = tau;
  Vector<2> z = y;
  integrators::exchange<E>(s, z);
  const auto trial = integrators::extrapolated_step(exchanged, s, z, target - s, tolerance);
  suggested_step = trial.suggested_step;
  if (!trial.converged) return false;
  tau = trial.state[E];
  y = trial.state;
  y[E] = target;
  return true;
}

// Goes on to exactly y[distance] = target, known to lie ahead, with as many steps as it takes.
int go_to_distance(TravelEquation& equation, double target, double& tau, Vector<2>& y) {
  integrators::Exchanged<2, distance, TravelEquation> exchanged(equation);
  double s = tau;
  Vector<2> z = y;
  integrators::exchange<distance>(s, z);
  const auto result = integrators::integrate(exchanged, s, z, target, target - s, tolerance);
  tau = result.state[distance];
  y = {target, result.state[speed]};
  return result.steps;
}

}  // namespace

Slide::Segment Slide::slide_by_integration(double duration_s) {
  TravelEquation equation(friction_, force_, state_, time_rest_s_, direction_, mass_kg_);
  const double edge_m = edge_distance_m();
  const double longest_s = observer_ ? std::min(duration_s, observer_interval_s_) : duration_s;
  Vector<2> y{0, std::abs(state_.velocity_m_s)};
  double tau = 0, step_s = next_step_s_ > 0 ? next_step_s_ : first_step_s(duration_s);
  bool outlasts = false;  // known not to come to rest within the duration
  for (int halvings = 0; halvings < max_halvings;) {
    const double acceleration = equation.acceleration(tau, y[distance], y[speed]);
    const double remaining_s = duration_s - tau;
    const double step = std::min({step_s, longest_s, remaining_s});
    if (!outlasts && acceleration < 0 && y[speed] > 0 && y[speed] + 2 * step * acceleration <= 0) {
      // Rest may be near: let the speed be the independent variable. Its step must be one of steady deceleration.
      double end_tau = tau, suggested = 0, drop = std::min(y[speed], -acceleration * longest_s);
      Vector<2> end = y;
      equation.forget_range();
      bool reached = step_to<speed>(equation, y[speed] - drop, end_tau, end, suggested);
      for (; !reached && equation.greatest() < 0 && halvings < max_halvings; ++halvings) {
        drop = std::min(0.5 * drop, std::abs(suggested));
        reached = step_to<speed>(equation, y[speed] - drop, end_tau, end, suggested);
      }
      if (reached && equation.greatest() < 0) {
        if (end[distance] >= edge_m) {
          counters_.steps += static_cast<std::uint64_t>(go_to_distance(equation, edge_m, tau, y));
          return {tau, edge_m, y[speed], Ending::edge};
        }
        if (end_tau > duration_s) {
          outlasts = true;
          continue;
        }
        ++counters_.steps;
        halvings = 0;
        tau = end_tau;
        y = end;
        if (y[speed] == 0) return {tau, y[distance], 0, Ending::rest};
        if (observer_) observe_at(tau, y[distance], y[speed]);
        continue;
      }
      step_s = 0.25 * y[speed] / -acceleration;  // the speed may have a minimum ahead
      ++halvings;
      continue;
    }
    equation.forget_range();
    const auto trial = integrators::extrapolated_step(equation, tau, y, step, tolerance);
    const bool may_stop = !outlasts && y[speed] + step * std::min(equation.least(), 0.0) <= 0 && equation.least() < 0;
    if (!trial.converged || may_stop || trial.state[speed] <= 0) {
      step_s = trial.converged ? 0.5 * step : std::min(trial.suggested_step, 0.7 * step);
      ++halvings;
      continue;
    }
    if (trial.state[distance] >= edge_m) {
      if (y[speed] > 0) {
        counters_.steps += static_cast<std::uint64_t>(go_to_distance(equation, edge_m, tau, y));
        return {tau, edge_m, y[speed], Ending::edge};
      }
      step_s = 0.5 * step;
      ++halvings;
      continue;
    }
    ++counters_.steps;
    halvings = 0;
    y = trial.state;
    const bool cut_short = step < step_s;
    step_s = cut_short ? std::max(step_s, trial.suggested_step) : trial.suggested_step;
    next_step_s_ = step_s;
    if (step == remaining_s) return {duration_s, y[distance], y[speed], Ending::time};
    tau += step;
    if (observer_) observe_at(tau, y[distance], y[speed]);
  }
  return {tau, y[distance], 0, Ending::rest};
}

// The shortest of the scene's own scales of time.
double Slide::first_step_s(double duration_s) const {
  double step_s = std::min(duration_s, friction_.time_scale_s());
  if (force_.stiffness_N_per_m > 0) step_s = std::min(step_s, std::sqrt(mass_kg_ / force_.stiffness_N_per_m));
  if (force_.damping_Ns_per_m > 0) step_s = std::min(step_s, mass_kg_ / force_.damping_Ns_per_m);
  if (force_.transient_N != 0) step_s = std::min(step_s, force_.time_constant_s);
  return step_s;
}

}  // namespace breakaway::plant
