#include "breakaway/motion/compliant_axis.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "breakaway/input/numbers.hpp"
#include "compliant_motion.hpp"

namespace breakaway::motion {

CompliantAxis::Motion::Motion(model::CompliantPlant plant, model::FrictionLaw friction, const SlideState& initial,
                              double tolerance)
    : plant_{std::move(plant)}, time_{initial.time_s}, tolerance_{tolerance} {
  if (!(tolerance >= 1e-14 && tolerance <= 1e-2))
    throw InputError{"tolerance is " + to_text(tolerance) + "; give a number from 1e-14 to 1e-2"};
  model::require_valid(plant_);
  if (!std::isfinite(initial.time_s + initial.position_m + initial.velocity_m_s))
    throw InputError{"the start is not finite; correct it"};
  y_[position] = initial.position_m;
  y_[velocity] = y_[load_velocity] = initial.velocity_m_s;
  piece_.motor.law.emplace(std::move(friction));
  piece_.motor.direction = sign_of(initial.velocity_m_s);
  if (bristles() && piece_.motor.direction == 0) piece_.motor.direction = 1;
  if (plant_.load) {
    piece_.load.law = std::move(plant_.load->friction);
    piece_.load.direction = sign_of(initial.velocity_m_s);
  }
  for (DryContact* contact : {&piece_.motor, &piece_.load})
    if (contact->law) contact->next_change_s = initial.time_s;
  change_laws();
}

CompliantState CompliantAxis::Motion::state() const {
  const bool load = plant_.load.has_value();
  return {time_.sum_s,
          y_[position],
          y_[velocity],
          load ? load_place_m() : y_[position],
          load ? y_[load_velocity] : y_[velocity],
          y_[bend]};
}

bool CompliantAxis::Motion::sticking() const {
  if (piece_.load.law && !piece_.load.sticks()) return false;
  if (!bristles()) return piece_.motor.sticks();
  const CompliantEquation motion = equation();
  const model::Presliding& p = *plant_.presliding;
  const double level_N = motion.motor_level_N(0, y_), push_N = motion.push_on_motor_N(0, y_);
  const double vibration_N = std::hypot(std::sqrt(p.stiffness_N_per_m * plant_.mass_kg) * y_[velocity],
                                        p.stiffness_N_per_m * y_[bend] - push_N);
  return std::abs(push_N) + vibration_N < level_N;
}

double CompliantAxis::Motion::friction_force_N() const {
  const CompliantEquation motion = equation();
  if (bristles() || !piece_.motor.sticks()) return -motion.friction_N(0, y_);
  return -std::clamp(motion.push_on_motor_N(0, y_), -piece_.motor.rest_level_N[0], piece_.motor.rest_level_N[1]);
}

double CompliantAxis::Motion::energy_J() const {
  double energy_J = 0.5 * plant_.mass_kg * y_[velocity] * y_[velocity];
  if (bristles()) energy_J += plant_.presliding->energy_J(y_[bend]);
  if (!plant_.load) return energy_J;
  return energy_J + 0.5 * plant_.load->mass_kg * y_[load_velocity] * y_[load_velocity] +
         plant_.load->coupling.energy_J(y_[deflection]);
}

CompliantAxis::CompliantAxis(model::CompliantPlant plant, model::FrictionLaw friction, SlideState initial,
                             double tolerance)
    : motion_{std::make_unique<Motion>(std::move(plant), std::move(friction), initial, tolerance)} {}
CompliantAxis::CompliantAxis(CompliantAxis&&) noexcept = default;
CompliantAxis& CompliantAxis::operator=(CompliantAxis&&) noexcept = default;
CompliantAxis::~CompliantAxis() = default;

void CompliantAxis::advance_to(double time_s, const model::AppliedForce& force) { motion_->advance_to(time_s, force); }
CompliantState CompliantAxis::state() const { return motion_->state(); }
bool CompliantAxis::sticking() const { return motion_->sticking(); }
double CompliantAxis::friction_force_N() const { return motion_->friction_force_N(); }
double CompliantAxis::energy_J() const { return motion_->energy_J(); }
void CompliantAxis::limit_work(WorkBudget* budget) { motion_->limit_work(budget); }
const CompliantCounters& CompliantAxis::counters() const { return motion_->counters(); }

}  // namespace breakaway::motion
