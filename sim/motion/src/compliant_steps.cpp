#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "compliant_motion.hpp"

namespace breakaway::motion {
namespace {

// Shares of the speed in the norm of the energy, for a tolerance of 1: the friction of a Slide is judged by the speed.
constexpr double explicit_share = 100, implicit_share = 3000;
// An explicit step is stable up to some tens of relaxation times, and accurate for a few at least. A linearly implicit
// one costs about twice as much: it pays where it is longer than the explicit one by more than that.
constexpr double most_relaxations = 24, least_relaxations = 2, gain_of_implicit = 2.5;
// The step of the method that is not taken is forgotten so fast, for it may pay again.
constexpr double explicit_growth = 1.05, implicit_growth = 2;
constexpr double force_rounding = 1e-15;  // of a sum of forces
constexpr int most_refusals = 200;

void require_sound(const model::AppliedForce& force) {
  if (!std::isfinite(force.constant_N + force.transient_N + force.start_s))
    throw InputError{"the force is not finite; correct it"};
  if (force.has_feedback()) throw InputError{"the force has feedback; a compliant axis takes what a drive makes"};
  if (force.transient_N != 0 && !(force.time_constant_s > 0)) throw InputError{"time_constant_s must be positive"};
}

// An axis without a load has three of the components, which take far less than half of the work.
using AloneVector = Vector<3>;
constexpr std::array alone{position, velocity, bend};

AloneVector reduced(const CompliantVector& y) { return {y[position], y[velocity], y[bend]}; }

CompliantVector expanded(const AloneVector& y) {
  CompliantVector all{};
  for (std::size_t i = 0; i < alone.size(); ++i) all[alone[i]] = y[i];
  return all;
}

ExtrapolatedStep<CompliantVector> expanded(const ExtrapolatedStep<AloneVector>& step) {
  return {step.converged, expanded(step.state), step.suggested_step};
}

Matrix<alone.size()> reduced(const Matrix<components>& jacobian) {
  Matrix<alone.size()> j;
  for (std::size_t i = 0; i < alone.size(); ++i) j[i] = reduced(jacobian[alone[i]]);
  return j;
}

class AloneEquation {
 public:
  explicit AloneEquation(CompliantEquation& motion) : motion_{motion} {}

  void operator()(double tau_s, const AloneVector& y, AloneVector& derivative) {
    CompliantVector all;
    motion_(tau_s, expanded(y), all);
    derivative = reduced(all);
  }

 private:
  CompliantEquation& motion_;
};

ExtrapolatedStep<CompliantVector> explicit_step(CompliantEquation& motion, bool has_load, const CompliantVector& y,
                                                double step_s, const CompliantVector& floor) {
  if (has_load) return extrapolated_step(motion, 0, y, step_s, 0, floor);
  return expanded(extrapolated_step(AloneEquation{motion}, 0, reduced(y), step_s, 0, reduced(floor)));
}

ExtrapolatedStep<CompliantVector> implicit_step(CompliantEquation& motion, bool has_load, const CompliantVector& y,
                                                double step_s, const CompliantVector& floor) {
  const Matrix<components> jacobian = motion.jacobian(0, y);
  if (has_load) return linearly_implicit_step<components>(motion, jacobian, 0, y, step_s, floor);
  return expanded(linearly_implicit_step<alone.size()>(AloneEquation{motion}, reduced(jacobian), 0, reduced(y), step_s,
                                                       reduced(floor)));
}

}  // namespace

void CompliantAxis::Motion::advance_to(double time_s, const model::AppliedForce& force) {
  if (!std::isfinite(time_s)) throw InputError{"time_s is not finite; correct it"};
  if (time_s < time_.sum_s) throw InputError{"time_s lies before the state's time; give a later one"};
  require_sound(force);
  force_ = force;
  at_once_ = 0;
  release_what_is_pushed();
  while (time_.until(time_s) > 0) {
    const double change_s = std::min(piece_.motor.next_change_s, piece_.load.next_change_s);
    const double end_s = std::min(time_s, change_s);
    move(time_.until(end_s), end_s);
    if (time_.sum_s < change_s) continue;
    change_laws();
    release_what_is_pushed();
  }
  const bool held = sticking();
  if (bristles() && held_ && !held) ++counters_.slips;
  held_ = held;
}

// Moves by one step or to the end of a piece, at most to end_s.
void CompliantAxis::Motion::move(double duration_s, double end_s) {
  if (at_once_ == most_at_once + 1) return leave_instant(end_s);
  const double longest_s = longest_step_s(duration_s);
  const bool implicit = pays_to_be_implicit(std::min(longest_s, implicit_step_s_));
  double& next_s = implicit ? implicit_step_s_ : explicit_step_s_;
  double step_s = std::min(longest_s, next_s);
  implicit ? explicit_step_s_ *= explicit_growth : implicit_step_s_ *= implicit_growth;
  for (int refusals = 0; refusals < most_refusals; ++refusals) {
    const Trial trial = try_step(step_s, implicit);
    if (!trial.step.converged) {
      step_s = next_s = std::min(trial.step.suggested_step, 0.7 * step_s);
      if (implicit && !pays_to_be_implicit(step_s)) return;  // the explicit one is to try
      continue;
    }
    if (const auto end = first_end(trial.step.state, step_s)) return go_to_end(*end, step_s, implicit);
    if (trial.ended_inside) {
      step_s *= 0.5;
      continue;
    }
    const bool cut_short = step_s < next_s;
    next_s = cut_short ? std::max(next_s, trial.step.suggested_step) : trial.step.suggested_step;
    at_once_ = 0;
    return accept(trial.step.state, step_s, step_s == duration_s ? std::optional{end_s} : std::nullopt);
  }
  throw InputError{
      "the motion of the axis cannot be followed: its steps fell below the resolution of time; lower its "
      "stiffness or its damping"};
}

bool CompliantAxis::Motion::pays_to_be_implicit(double step_s) const {
  const double relaxation_per_s = equation().relaxation_per_s(0, y_);
  const double explicit_relaxations =
      std::clamp(relaxation_per_s * explicit_step_s_, least_relaxations, most_relaxations);
  return relaxation_per_s * step_s > gain_of_implicit * explicit_relaxations;
}

// What stands still lets steps grow without end, and laws that change with time would go unseen.
double CompliantAxis::Motion::longest_step_s(double duration_s) const {
  double longest_s = duration_s;
  for (const DryContact* contact : {&piece_.motor, &piece_.load})
    if (contact->law && contact->law->varies_with_time())
      longest_s = std::min(longest_s, 0.5 * contact->law->time_scale_s());
  return longest_s;
}

// The speed in the norm of the energy, and what the step adds to it.
double CompliantAxis::Motion::speed_scale_m_s(CompliantEquation& equation, double step_s) const {
  CompliantVector slope;
  equation(0, y_, slope);
  const double mass_kg = plant_.mass_kg;
  return std::sqrt(2 * energy_J() / mass_kg) + std::abs(slope[velocity]) * step_s;
}

// What a law's level is uncertain by, because time and place are rounded.
double CompliantAxis::Motion::rounding_of_law_N(const DryContact& contact, double place_m) const {
  if (!contact.law) return 0;
  const model::FrictionBounds& bounds = contact.law->bounds();
  return std::numeric_limits<double>::epsilon() * (bounds.upper_N - bounds.lower_N) *
         (std::abs(time_.sum_s) / contact.law->time_scale_s() + std::abs(place_m) / contact.law->position_scale_m());
}

// What a sum of forces is uncertain by.
double CompliantAxis::Motion::rounding_N() const {
  const double place = std::numeric_limits<double>::epsilon() * std::abs(y_[position]);
  const double drive_N = std::abs(force_.constant_N) + std::abs(force_.transient_N);
  return force_rounding * forces_N() +
         place * (plant_.cogging.amplitude * plant_.cogging.wave_number_per_m() +
                  plant_.ripple.amplitude * plant_.ripple.wave_number_per_m() * drive_N) +
         rounding_of_law_N(piece_.motor, y_[position]) + rounding_of_law_N(piece_.load, load_place_m());
}

// What an acceleration is the difference of.
double CompliantAxis::Motion::forces_N() const {
  double sum_N = std::abs(force_.constant_N) + std::abs(force_.transient_N) + std::abs(plant_.force_N) +
                 piece_.motor.law->bounds().upper_N + plant_.cogging.amplitude;
  if (plant_.load) sum_N += std::abs(equation().coupling_N(y_));
  if (piece_.load.law) sum_N += piece_.load.law->bounds().upper_N;
  return sum_N;
}

CompliantVector CompliantAxis::Motion::floor(double scale_m_s, double tolerance, double step_s) const {
  const double tiny = std::numeric_limits<double>::min();
  const double speed = tolerance * scale_m_s + rounding_N() / plant_.mass_kg * step_s + tiny;
  CompliantVector floor{speed * step_s + tiny, speed, speed * step_s + tiny, speed, tiny};
  if (plant_.load) {
    const double mass_kg = std::max(plant_.load->mass_kg, plant_.mass_kg);
    floor[load_velocity] *= std::sqrt(plant_.mass_kg / plant_.load->mass_kg);
    const double swing_s = std::sqrt(mass_kg / plant_.load->coupling.stiffness_N_per_m);
    floor[deflection] = speed * std::min(step_s, swing_s) + tiny;
  } else {
    floor[deflection] = floor[load_velocity] = 1;
  }
  if (!bristles()) {
    floor[bend] = 1;
    return floor;
  }
  const double stiffness_N_per_m = plant_.presliding->stiffness_N_per_m;
  const double most_m = piece_.motor.law->bounds().upper_N / stiffness_N_per_m;
  floor[bend] = std::min(speed * std::sqrt(plant_.mass_kg / stiffness_N_per_m), tolerance * most_m) + tiny;
  return floor;
}

CompliantAxis::Motion::Trial CompliantAxis::Motion::try_step(double step_s, bool implicit) {
  ++counters_.tries;
  const Trial trial = step_by(step_s, implicit);
  if (budget_ != nullptr) budget_->spend(time_.sum_s, trial.evaluations);
  return trial;
}

CompliantAxis::Motion::Trial CompliantAxis::Motion::step_by(double step_s, bool implicit) const {
  CompliantEquation motion = equation();
  const double scale_m_s = speed_scale_m_s(motion, step_s);
  Trial trial;
  if (!implicit) {
    trial.step = explicit_step(motion, plant_.load.has_value(), y_, step_s,
                               floor(scale_m_s, explicit_share * tolerance_, step_s));
    trial.ended_inside = motion.ended_inside();
    trial.evaluations = motion.evaluations();
    return trial;
  }
  motion.watch_coarsely();
  trial.step =
      implicit_step(motion, plant_.load.has_value(), y_, step_s, floor(scale_m_s, implicit_share * tolerance_, step_s));
  trial.ended_inside = motion.ended_inside() || motion.slack_fails_between(y_, trial.step.state, step_s);
  trial.evaluations = motion.evaluations();
  return trial;
}

void CompliantAxis::Motion::accept(const CompliantVector& y, double step_s, std::optional<double> end_s) {
  ++counters_.steps;
  y_ = y;
  if (end_s) {
    time_ = {*end_s};
  } else {
    time_.pass(step_s);
  }
}

}  // namespace breakaway::motion
