// FrictionLaw: bounds and a shape, together the friction force level f in F_f in -f Sign(v), eq. (1) of van de Wouw &
// Leine. A value: copies are deep and replay the same randomness.
#pragma once

#include "breakaway/input/input_error.hpp"
#include "breakaway/law/friction_bounds.hpp"
#include "breakaway/model/shape.hpp"

namespace breakaway::model {

using FrictionBounds = law::FrictionBounds<double>;

// Returns the bounds from the paper's coefficients, m g mu. Throws InputError naming the parameter unless mass_kg > 0,
// gravity_m_s2 > 0 and 0 < mu_lower <= mu_upper, all finite.
FrictionBounds bounds_from_coefficients(double mass_kg, double gravity_m_s2, double mu_lower, double mu_upper);

class FrictionLaw {
 public:
  // Throws InputError when there is no shape, and unless 0 < lower_N <= upper_N < infinity.
  FrictionLaw(FrictionBounds bounds, ShapePtr shape);
  FrictionLaw(const FrictionLaw& other);
  FrictionLaw& operator=(const FrictionLaw& other);
  FrictionLaw(FrictionLaw&&) noexcept = default;
  FrictionLaw& operator=(FrictionLaw&&) noexcept = default;

  const FrictionBounds& bounds() const { return bounds_; }

  // Returns lower + (upper - lower) * shape for the piece chosen by the last face(), always within the bounds.
  double level_N(double time_s, double position_m, double speed_m_s) const;

  // Returns the force that motion in `direction` (-1, +1) must overcome: the level at rest, or the level at the first
  // motion where that is the greater (a force between the two cannot move the axis). Leaves the piece for rest chosen.
  double breakaway_N(double time_s, double position_m, int direction);

  bool constant_between_events() const { return !varies_with_motion() && !varies_with_time(); }
  bool varies_with_motion() const { return shape_->varies_with_motion(); }
  bool varies_with_time() const { return time_scale_s() < std::numeric_limits<double>::infinity(); }
  double time_scale_s() const { return shape_->time_scale_s(); }
  double position_scale_m() const { return shape_->position_scale_m(); }
  double next_time_change_s() const { return shape_->next_time_change_s(); }
  PositionRange range_m() const { return shape_->range_m(); }

  void face(double position_m, int direction) { shape_->face(position_m, direction); }
  void on_time(double time_s) { shape_->on_time(time_s); }
  void on_stick(double time_s) { shape_->on_stick(time_s); }
  void on_slip(double time_s) { shape_->on_slip(time_s); }

 private:
  FrictionBounds bounds_;
  ShapePtr shape_;
};

}  // namespace breakaway::model
