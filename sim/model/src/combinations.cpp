#include <algorithm>
#include <numeric>
#include <utility>

#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shapes.hpp"
#include "require.hpp"

namespace breakaway::model::shape {
namespace {

// Forwards every event to its parts; a combination's own piece ends where the first of theirs does.
class Combination : public Shape {
 public:
  explicit Combination(std::vector<ShapePtr> parts) : parts_(std::move(parts)) {
    const auto missing = [](const ShapePtr& part) { return part == nullptr; };
    if (parts_.empty() || std::any_of(parts_.begin(), parts_.end(), missing)) {
      throw InputError{"parts of a combination must not be empty or null"};
    }
  }
  Combination(const Combination& other) : Shape(other) {
    for (const auto& part : other.parts_) parts_.push_back(part->clone());
  }

  void face(double position_m, int direction) final {
    for (auto& part : parts_) part->face(position_m, direction);
  }
  void on_time(double time_s) final {
    for (auto& part : parts_) part->on_time(time_s);
  }
  void on_stick(double time_s) final {
    for (auto& part : parts_) part->on_stick(time_s);
  }
  void on_slip(double time_s) final {
    for (auto& part : parts_) part->on_slip(time_s);
  }
  double next_time_change_s() const final {
    double next_s = std::numeric_limits<double>::infinity();
    for (const auto& part : parts_) next_s = std::min(next_s, part->next_time_change_s());
    return next_s;
  }
  PositionRange range_m() const final {
    PositionRange range;
    for (const auto& part : parts_) {
      range.lower_m = std::max(range.lower_m, part->range_m().lower_m);
      range.upper_m = std::min(range.upper_m, part->range_m().upper_m);
    }
    return range;
  }
  bool varies_with_motion() const final {
    return std::any_of(parts_.begin(), parts_.end(), [](const auto& part) { return part->varies_with_motion(); });
  }
  double time_scale_s() const final {
    double rate_per_s = 0;  // the frequencies of a product add up
    for (const auto& part : parts_) rate_per_s += 1 / part->time_scale_s();
    return 1 / rate_per_s;
  }
  double position_scale_m() const final {
    double rate_per_m = 0;
    for (const auto& part : parts_) rate_per_m += 1 / part->position_scale_m();
    return 1 / rate_per_m;
  }

 protected:
  const std::vector<ShapePtr>& parts() const { return parts_; }

 private:
  std::vector<ShapePtr> parts_;
};

class Mean : public Combination {
 public:
  Mean(std::vector<double> weights, std::vector<ShapePtr> parts)
      : Combination(std::move(parts)), weights_(std::move(weights)) {
    if (weights_.size() != this->parts().size()) throw InputError{"weights must be one for each part"};
    for (const double weight : weights_) {
      if (!(weight >= 0)) throw InputError{"weights must not be negative or NaN"};
    }
    const double sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    require_positive("sum of weights", sum);
    for (double& weight : weights_) weight /= sum;
  }
  ShapePtr clone() const override { return std::make_unique<Mean>(*this); }
  double value(double time_s, double position_m, double speed_m_s) const override {
    double sum = 0;
    const double* weight = weights_.data();
    for (const ShapePtr& part : parts()) sum += *weight++ * part->value(time_s, position_m, speed_m_s);
    return sum;
  }

 private:
  std::vector<double> weights_;
};

struct Multiply {
  double operator()(double a, double b) const { return a * b; }
};
struct Greater {
  double operator()(double a, double b) const { return std::max(a, b); }
};
struct Smaller {
  double operator()(double a, double b) const { return std::min(a, b); }
};

template <class Operation>
class Fold : public Combination {
 public:
  using Combination::Combination;
  ShapePtr clone() const override { return std::make_unique<Fold>(*this); }
  double value(double time_s, double position_m, double speed_m_s) const override {
    double result = parts().front()->value(time_s, position_m, speed_m_s);
    for (std::size_t i = 1; i < parts().size(); ++i) {
      result = Operation()(result, parts()[i]->value(time_s, position_m, speed_m_s));
    }
    return result;
  }
};

class Complement : public Combination {
 public:
  using Combination::Combination;
  ShapePtr clone() const override { return std::make_unique<Complement>(*this); }
  double value(double time_s, double position_m, double speed_m_s) const override {
    return 1 - parts().front()->value(time_s, position_m, speed_m_s);
  }
};

}  // namespace

ShapePtr mean(std::vector<double> weights, std::vector<ShapePtr> parts) {
  return std::make_unique<Mean>(std::move(weights), std::move(parts));
}

ShapePtr product(std::vector<ShapePtr> parts) { return std::make_unique<Fold<Multiply>>(std::move(parts)); }

ShapePtr maximum(std::vector<ShapePtr> parts) { return std::make_unique<Fold<Greater>>(std::move(parts)); }

ShapePtr minimum(std::vector<ShapePtr> parts) { return std::make_unique<Fold<Smaller>>(std::move(parts)); }

ShapePtr complement(ShapePtr part) {
  std::vector<ShapePtr> parts;
  parts.push_back(std::move(part));
  return std::make_unique<Complement>(std::move(parts));
}

}  // namespace breakaway::model::shape
