// A Shape says where between its bounds the friction is, as a number in [0, 1].
//
// A shape is smooth between its own events. The events are: a time that it announces, the ends of the position range
// that it announces, coming to rest (stick) and leaving rest (slip). The plant integrates from event to event and tells
// the shape of each, so that no integration step ever meets a jump.
#pragma once

#include <limits>
#include <memory>

namespace breakaway::model {

struct PositionRange {
  double lower_m = -std::numeric_limits<double>::infinity();
  double upper_m = std::numeric_limits<double>::infinity();
};

class Shape {
 public:
  virtual ~Shape() = default;
  virtual std::unique_ptr<Shape> clone() const = 0;

  // Returns the value in [0, 1] of the current piece. speed_m_s is along the direction of motion; a trial step of an
  // integrator may ask for a slightly negative one and wants the smooth continuation.
  virtual double value(double time_s, double position_m, double speed_m_s) const = 0;

  // Chooses the piece for motion in `direction` (-1, +1) from here, or for rest (0).
  virtual void face(double /*position_m*/, int /*direction*/) {}
  // The shape is told once at the start and then at every next_time_change_s().
  virtual void on_time(double /*time_s*/) {}
  virtual void on_stick(double /*time_s*/) {}
  virtual void on_slip(double /*time_s*/) {}

  virtual double next_time_change_s() const { return std::numeric_limits<double>::infinity(); }
  virtual PositionRange range_m() const { return {}; }  // where the current piece holds
  // These state a smooth dependence between events: on position or velocity; and on time, as the shortest time in which
  // the value may go from a maximum to the next minimum, divided by pi (1 / angular frequency for a sine); infinity for
  // none.
  virtual bool varies_with_motion() const { return false; }
  virtual double time_scale_s() const { return std::numeric_limits<double>::infinity(); }
  // The same on position, as a length.
  virtual double position_scale_m() const { return std::numeric_limits<double>::infinity(); }

 protected:
  Shape() = default;
  Shape(const Shape&) = default;
  Shape& operator=(const Shape&) = default;
};

using ShapePtr = std::unique_ptr<Shape>;

}  // namespace breakaway::model
