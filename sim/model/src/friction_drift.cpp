#include "breakaway/model/friction_drift.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "require.hpp"

namespace breakaway::model {
namespace {

FrictionBounds widened(const FrictionBounds& bounds, double share) {
  return {bounds.lower_N * (1 - share), bounds.upper_N * (1 + share)};
}

class Drifting final : public Shape {
 public:
  Drifting(FrictionLaw law, const FrictionDrift& drift)
      : law_{std::move(law)},
        bounds_{widened(law_.bounds(), drift.share)},
        share_{drift.share},
        angular_frequency_rad_s_{2 * std::numbers::pi / drift.period_s} {}

  ShapePtr clone() const override { return std::make_unique<Drifting>(*this); }

  double value(double time_s, double position_m, double speed_m_s) const override {
    const double factor = 1 + share_ * std::sin(angular_frequency_rad_s_ * time_s);
    return (law_.level_N(time_s, position_m, speed_m_s) * factor - bounds_.lower_N) /
           (bounds_.upper_N - bounds_.lower_N);
  }
  void face(double position_m, int direction) override { law_.face(position_m, direction); }
  void on_time(double time_s) override { law_.on_time(time_s); }
  void on_stick(double time_s) override { law_.on_stick(time_s); }
  void on_slip(double time_s) override { law_.on_slip(time_s); }
  double next_time_change_s() const override { return law_.next_time_change_s(); }
  PositionRange range_m() const override { return law_.range_m(); }
  bool varies_with_motion() const override { return law_.varies_with_motion(); }
  double position_scale_m() const override { return law_.position_scale_m(); }
  // The frequencies of a product add up.
  double time_scale_s() const override { return 1 / (1 / law_.time_scale_s() + angular_frequency_rad_s_); }

 private:
  FrictionLaw law_;
  FrictionBounds bounds_;
  double share_;
  double angular_frequency_rad_s_;
};

}  // namespace

FrictionLaw drifting(const FrictionLaw& law, const FrictionDrift& drift) {
  require_positive("period_s", drift.period_s);
  if (!(drift.share > 0 && drift.share < 1))
    throw InputError{"share", "of the drift is " + to_text(drift.share) + "; give a number between 0 and 1"};
  return {widened(law.bounds(), drift.share), std::make_unique<Drifting>(law, drift)};
}

}  // namespace breakaway::model
