// The README's snippet, around a mass on dry friction that is just good enough to show that it works.
#include <breakaway/design/k3_table_builder.hpp>
#include <breakaway/design/pd_kicks.hpp>
#include <breakaway/law/axis_controller.hpp>
#include <cmath>
#include <iostream>

namespace {

struct SlidingMass {
  float x = -0.01F, v = 0;

  void advance(float force_N, float duration_s) {
    constexpr float friction_N = 3.3F;
    constexpr int steps = 1000;
    for (int i = 0; i < steps; ++i) {
      if (v == 0 && std::abs(force_N) <= friction_N) return;
      const float direction = v != 0 ? std::copysign(1.0F, v) : std::copysign(1.0F, force_N);
      const float next = v + (force_N - direction * friction_N) * duration_s / steps;
      v = next * direction < 0 ? 0 : next;
      x += v * duration_s / steps;
    }
  }
};

}  // namespace

int main() {
  SlidingMass axis;
  const auto position_error_m = [&] { return std::round(axis.x * 1e6F) * 1e-6F; };
  const auto hold_force_for_one_period = [&](float force_N) { axis.advance(force_N, 1e-3F); };
  int periods_left = 1000;

  // [README]
  breakaway::law::AxisParameters<float> parameters;
  parameters.mass_kg = 1;
  parameters.stiffness_N_per_m = 400;         // k1
  parameters.approach_damping_Ns_per_m = 32;  // k21, zeta < 1
  parameters.kick_damping_Ns_per_m = 60;      // k22, zeta > 1
  parameters.friction.lower_N = 2.5F;         // all that is known of the friction:
  parameters.friction.upper_N = 4.5F;         // it lies between these
  parameters.max_force_N = 50;
  parameters.encoder_resolution_m = 1e-6F;
  parameters.period_s = 1e-3F;
  parameters.position_tolerance_m = parameters.accuracy_floor_m();

  // On a PC.
  const auto k3 = breakaway::design::build_k3_table<float>({1, 400, 60, 2.5}, parameters.stick_radius_upper_m());
  const auto pulses = breakaway::design::design_pd_kicks(parameters);
  // Flashed: no heap, no exceptions.
  breakaway::law::AxisController<float> controller{parameters, k3.table, pulses.table};

  while (periods_left-- > 0) {
    const auto output = controller.update({position_error_m()});
    hold_force_for_one_period(output.force_N);
  }
  // [README]

  std::cout << "error " << axis.x << " m after " << controller.kicks() << " kicks\n";
  const bool settled = controller.mode() == breakaway::law::Mode::hold && std::abs(axis.x) < 3e-6F;
  return settled ? 0 : 1;
}
