#include "breakaway/model/friction_law.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "require.hpp"

namespace breakaway::model {

FrictionBounds bounds_from_coefficients(double mass_kg, double gravity_m_s2, double mu_lower, double mu_upper) {
  require_positive("mass_kg", mass_kg);
  require_positive("gravity_m_s2", gravity_m_s2);
  require_ordered("mu_lower", mu_lower, "mu_upper", mu_upper);
  return {mass_kg * gravity_m_s2 * mu_lower, mass_kg * gravity_m_s2 * mu_upper};
}

FrictionLaw::FrictionLaw(FrictionBounds bounds, ShapePtr shape) : bounds_(bounds), shape_(std::move(shape)) {
  require_ordered("lower_N", bounds.lower_N, "upper_N", bounds.upper_N);
  if (!shape_) throw InputError{"shape", "is missing; give the law one"};
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
  return std::min(bounds_.lower_N + shape * (bounds_.upper_N - bounds_.lower_N), bounds_.upper_N);
}

double FrictionLaw::breakaway_N(double time_s, double position_m, int direction) {
  face(position_m, direction);
  const double at_first_motion = level_N(time_s, position_m, 0);
  face(position_m, 0);
  return std::max(at_first_motion, level_N(time_s, position_m, 0));
}

}  // namespace breakaway::model
