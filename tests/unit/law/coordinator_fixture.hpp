// Axes that are kicked one after another, and a bench that feeds them, for the tests of the coordinator.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "breakaway/law/coordinator_parameters.hpp"
#include "breakaway/law/kick_coordinator.hpp"

namespace breakaway::law::coordinator_test {

using Parameters = CoordinatorParameters<double, 4>;
using Coordinator = KickCoordinator<double, 4>;
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// 2 kg with friction 2.5 to 4.5 N.
template <std::size_t Axes>
CoordinatedAxisParameters<double, Axes> an_axis() {
  return {.position_gain_N_per_m = 400,
          .velocity_gain_Ns_per_m = 40,
          .mass_kg = 2,
          .lower_N = 2.5,
          .upper_N = 4.5,
          .sure_N = 4.51,
          .brake_N = 0.5,
          .kick_N = 40,
          .max_force_N = 50,
          .gate_m = 0.02,
          .tolerance_m = 1e-5,
          .resolution_m = 1e-6,
          .hold_off = {}};
}

// Two of these; each asks a quarter of its force of the other.
inline Parameters two_axes() {
  Parameters p;
  p.period_s = 1e-3;
  p.count = 2;
  p.settling_periods = 2;
  p.still_periods = 3;
  p.release_periods = 5;
  p.most_kicks = 10;
  for (std::size_t i = 0; i < 2; ++i) p.axes[i] = an_axis<4>();
  p.axes[0].hold_off[1] = p.axes[1].hold_off[0] = 0.25;
  return p;
}

// Feeds readings and keeps the forces.
struct Bench {
  explicit Bench(const Parameters& parameters) : coordinator{parameters} {}

  void step(double first_m, double second_m) {
    outputs[0] = coordinator.update(0, {first_m, 0, true});
    outputs[1] = coordinator.update(1, {second_m, 0, true});
  }
  void steps(int count, double first_m, double second_m) {
    for (int n = 0; n < count; ++n) step(first_m, second_m);
  }
  // To the first period of the next kick.
  void to_kick(double first_m, double second_m) {
    bool kicked = false;
    for (int n = 0; n < 300 && !kicked; ++n) {
      step(first_m, second_m);
      kicked = outputs[0].kicked || outputs[1].kicked;
    }
  }
  double force_N(std::size_t axis) const { return outputs[axis].force_N; }

  Coordinator coordinator;
  std::array<ControlOutput<double>, 2> outputs{};
};

}  // namespace breakaway::law::coordinator_test
