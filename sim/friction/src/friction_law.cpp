#include "breakaway/friction/friction_law.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "require.hpp"

namespace breakaway::friction {

FrictionBounds::FrictionBounds(double lower, double upper) : lower_N(lower), upper_N(upper) {
  require_ordered("lower_N", lower, "upper_N", upper);
}

FrictionBounds FrictionBounds::from_coefficients(double mass_kg, double gravity_m_s2, double mu_lower,
                                                 double mu_upper) {
  require_positive("mass_kg", mass_kg);
  require_positive("gravity_m_s2", gravity_m_s2);
  require_ordered("mu_lower", mu_lower, "mu_upper", mu_upper);
  return {mass_kg * gravity_m_s2 * mu_lower, mass_kg * gravity_m_s2 * mu_upper};
}

FrictionLaw::FrictionLaw(FrictionBounds bounds, ShapePtr shape) : bounds_(bounds), shape_(std::move(shape)) {
  if (!shape_) throw std::invalid_argument("shape must not be null");
}

FrictionLaw::FrictionLaw(const FrictionLaw& other) : bounds_(other.bounds_), shape_(other.shape_->clone()) {}

FrictionLaw& FrictionLaw::operator=(const FrictionLaw& other) {
  bounds_ = other.bounds_;
  shape_ = other.shape_->clone();
  return *this;
}

double FrictionLaw::level_N(double time_s, double position_m, double speed_m_s) const {
  // The clamp bounds the last bit of a rounded shape, and the smooth continuation that trial steps ask for.
  const double shape = std::clamp(shape_->value(time_s, position_m, speed_m_s), 0.0, 1.0);
  return std::lerp(bounds_.lower_N, bounds_.upper_N, shape);
}

double FrictionLaw::breakaway_N(double time_s, double position_m, int direction) {
  face(position_m, direction);
  const double at_first_motion = level_N(time_s, position_m, 0);
  face(position_m, 0);
  return std::max(at_first_motion, level_N(time_s, position_m, 0));
}

}  // namespace breakaway::friction
