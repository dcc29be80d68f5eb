// The axis of the scenes under the coast "brake", whose positions a test dictates.
#pragma once

#include "../../kicked_axis.hpp"
#include "law_fixture.hpp"

namespace breakaway::law::testing {

inline AxisParameters<float> braked_axis(float tolerance_m = 2.2e-6F) {
  auto p = sampled_axis<float>();
  p.coast = Coast::brake;
  p.position_tolerance_m = tolerance_m;
  return p;
}

inline const K3Table<float> no_k3{};

// An axis that shows a position and records what it is told.
class Scripted {
 public:
  explicit Scripted(double lag_s, const AxisParameters<float>& parameters = braked_axis())
      : kicks_{design::design_braked_kicks<float>(breakaway::testing::axes_of_the_scenes(lag_s)).kicks},
        controller_{parameters, no_k3, kicks_} {}
  ControlOutput<float> show(float position_m) {
    const ControlOutput<float> out = controller_.update({position_m});
    expect_nothing_with_a_fault(controller_, out);
    return out;
  }
  ControlOutput<float> lose() { return controller_.update({0, 0, false}); }
  // Lets the axis be still at the position until a pulse starts; returns its force.
  float pulse_at(float position_m) {
    for (int i = 0; i < 300; ++i) {
      if (const auto out = show(position_m); out.kicked) return out.force_N;
    }
    return 0;
  }
  AxisController<float>& controller() { return controller_; }
  const BrakedKicks<float>& kicks() const { return kicks_; }

 private:
  BrakedKicks<float> kicks_;
  AxisController<float> controller_;
};

}  // namespace breakaway::law::testing
