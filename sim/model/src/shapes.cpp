#include "breakaway/model/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "require.hpp"

namespace breakaway::model::shape {
namespace {

// Adds the copy that every concrete shape makes of itself.
template <class Self>
class Cloneable : public Shape {
 public:
  ShapePtr clone() const final { return std::make_unique<Self>(static_cast<const Self&>(*this)); }
};

class Constant : public Cloneable<Constant> {
 public:
  explicit Constant(double value) : value_(value) { require_unit_interval("value", value); }
  double value(double, double, double) const override { return value_; }

 private:
  double value_;
};

class StaticKinetic : public Cloneable<StaticKinetic> {
 public:
  StaticKinetic(double at_rest, double sliding) : at_rest_(at_rest), sliding_(sliding) {
    require_unit_interval("static_value", at_rest);
    require_unit_interval("kinetic_value", sliding);
  }
  double value(double, double, double) const override { return slides_ ? sliding_ : at_rest_; }
  void face(double, int direction) override { slides_ = direction != 0; }

 private:
  double at_rest_;
  double sliding_;
  bool slides_ = false;
};

class Stribeck : public Cloneable<Stribeck> {
 public:
  explicit Stribeck(double velocity_m_s) : velocity_m_s_(velocity_m_s) {
    require_positive("stribeck_velocity_m_s", velocity_m_s);
  }
  double value(double, double, double speed_m_s) const override {
    return velocity_m_s_ / (velocity_m_s_ + std::max(speed_m_s, -0.5 * velocity_m_s_));
  }
  bool varies_with_motion() const override { return true; }

 private:
  double velocity_m_s_;
};

class StribeckGaussian : public Cloneable<StribeckGaussian> {
 public:
  explicit StribeckGaussian(double velocity_m_s) : velocity_m_s_(velocity_m_s) {
    require_positive("stribeck_velocity_m_s", velocity_m_s);
  }
  double value(double, double, double speed_m_s) const override {
    const double ratio = speed_m_s / velocity_m_s_;
    return std::exp(-ratio * ratio);
  }
  bool varies_with_motion() const override { return true; }

 private:
  double velocity_m_s_;
};

class SineInTime : public Cloneable<SineInTime> {
 public:
  SineInTime(double angular_frequency_rad_s, double phase_rad) : omega_(angular_frequency_rad_s), phase_(phase_rad) {
    require_positive("angular_frequency_rad_s", angular_frequency_rad_s);
    require_finite("phase_rad", phase_rad);
  }
  double value(double time_s, double, double) const override { return 0.5 * (1 + std::sin(omega_ * time_s + phase_)); }
  double time_scale_s() const override { return 1 / omega_; }

 private:
  double omega_;
  double phase_;
};

class SineInPosition : public Cloneable<SineInPosition> {
 public:
  SineInPosition(double period_m, double phase_rad) : wave_number_(2 * std::numbers::pi / period_m), phase_(phase_rad) {
    require_positive("period_m", period_m);
    require_finite("phase_rad", phase_rad);
  }
  double value(double, double position_m, double) const override {
    return 0.5 * (1 + std::sin(wave_number_ * position_m + phase_));
  }
  bool varies_with_motion() const override { return true; }
  double position_scale_m() const override { return 1 / wave_number_; }

 private:
  double wave_number_;
  double phase_;
};

class PositionTable : public Cloneable<PositionTable> {
 public:
  PositionTable(std::vector<double> edges_m, std::vector<double> values)
      : edges_m_(std::move(edges_m)), values_(std::move(values)) {
    for (const double edge : edges_m_) require_finite("edges_m", edge);
    for (const double value : values_) require_unit_interval("values", value);
    if (std::adjacent_find(edges_m_.begin(), edges_m_.end(), std::greater_equal<>()) != edges_m_.end()) {
      throw InputError{"edges_m must increase strictly"};
    }
    if (values_.size() != edges_m_.size() + 1) {
      throw InputError{"values must hold one entry more than edges_m"};
    }
  }
  double value(double, double, double) const override { return values_[cell_]; }
  void face(double position_m, int direction) override {
    // An edge belongs to the cell that the motion enters.
    const auto edge = direction < 0 ? std::lower_bound(edges_m_.begin(), edges_m_.end(), position_m)
                                    : std::upper_bound(edges_m_.begin(), edges_m_.end(), position_m);
    cell_ = static_cast<std::size_t>(edge - edges_m_.begin());
  }
  PositionRange range_m() const override {
    PositionRange range;
    if (cell_ > 0) range.lower_m = edges_m_[cell_ - 1];
    if (cell_ < edges_m_.size()) range.upper_m = edges_m_[cell_];
    return range;
  }

 private:
  std::vector<double> edges_m_;
  std::vector<double> values_;
  std::size_t cell_ = 0;
};

class RandomDwellShape : public Cloneable<RandomDwellShape> {
 public:
  explicit RandomDwellShape(const RandomDwell& parameters) : parameters_(parameters), state_(parameters.seed) {
    require_ordered("shortest_dwell_s", parameters.shortest_dwell_s, "longest_dwell_s", parameters.longest_dwell_s);
    require_unit_interval("bound_share", parameters.bound_share);
  }
  double value(double, double, double) const override { return value_; }
  void on_time(double time_s) override {
    if (time_s >= next_change_s_) redraw(time_s);
  }
  void on_stick(double time_s) override { redraw(time_s); }
  void on_slip(double time_s) override { redraw(time_s); }
  double next_time_change_s() const override { return next_change_s_; }

 private:
  void redraw(double time_s) {
    const bool at_bound = uniform() < parameters_.bound_share;
    value_ = uniform();
    if (at_bound) value_ = value_ < 0.5 ? 0 : 1;
    const double ratio = parameters_.longest_dwell_s / parameters_.shortest_dwell_s;
    const double dwell_s = parameters_.shortest_dwell_s * std::pow(ratio, uniform());
    // A dwell below the resolution of time would never pass.
    next_change_s_ = std::max(time_s + dwell_s, std::nextafter(time_s, std::numeric_limits<double>::infinity()));
  }

  // SplitMix64 (Steele, Lea & Flood 2014): the standard library's distributions differ between platforms.
  double uniform() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t bits = state_;
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
    bits ^= bits >> 31;
    return static_cast<double>(bits >> 11) * 0x1p-53;
  }

  RandomDwell parameters_;
  std::uint64_t state_;
  double value_ = 0;
  double next_change_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace

ShapePtr constant(double value) { return std::make_unique<Constant>(value); }

ShapePtr static_kinetic(double static_value, double kinetic_value) {
  return std::make_unique<StaticKinetic>(static_value, kinetic_value);
}

ShapePtr stribeck(double stribeck_velocity_m_s) { return std::make_unique<Stribeck>(stribeck_velocity_m_s); }

ShapePtr stribeck_gaussian(double stribeck_velocity_m_s) {
  return std::make_unique<StribeckGaussian>(stribeck_velocity_m_s);
}

ShapePtr sine_in_time(double angular_frequency_rad_s, double phase_rad) {
  return std::make_unique<SineInTime>(angular_frequency_rad_s, phase_rad);
}

ShapePtr sine_in_position(double period_m, double phase_rad) {
  return std::make_unique<SineInPosition>(period_m, phase_rad);
}

ShapePtr position_table(std::vector<double> edges_m, std::vector<double> values) {
  return std::make_unique<PositionTable>(std::move(edges_m), std::move(values));
}

ShapePtr random_dwell(const RandomDwell& parameters) { return std::make_unique<RandomDwellShape>(parameters); }

}  // namespace breakaway::model::shape
