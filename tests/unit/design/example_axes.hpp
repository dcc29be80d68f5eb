// The axis of the scenes, as `design` is asked for it: 1 kg, 2.5 to 4.5 N, 1 kHz, 1 um.
#pragma once

#include "breakaway/design/report.hpp"

namespace breakaway::testing {

// Under the coast "pd".
inline design::AxisDesign sprung_example() {
  return {.mass_kg = 1,
          .stiffness_N_per_m = 400,
          .approach_damping_Ns_per_m = 32,
          .kick_damping_Ns_per_m = 60,
          .friction = {2.5, 4.5},
          .max_force_N = 50,
          .period_s = 1e-3,
          .encoder_resolution_m = 1e-6,
          .latency_ticks = 1,
          .position_tolerance_m = 1.8e-6};
}

// With what the coast "brake" needs to know.
inline design::AxisDesign braked_example() {
  design::AxisDesign axis = sprung_example();
  axis.braked = design::BrakedClass{.friction = axis.friction,
                                    .max_force_N = 50,
                                    .force_step_N = 0.025,
                                    .period_s = 1e-3,
                                    .encoder_resolution_m = 1e-6};
  return axis;
}

}  // namespace breakaway::testing
