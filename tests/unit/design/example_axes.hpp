// Axes as `design` is asked for them.
#pragma once

#include "breakaway/design/report.hpp"

namespace breakaway::testing {

// Section V of [I] behind a drive of 50 N at 1 kHz with an encoder of 1 um.
inline design::AxisDesign impulsive_example() {
  return {.mass_kg = 1,
          .stiffness_N_per_m = 1,
          .approach_damping_Ns_per_m = 0.5,
          .kick_damping_Ns_per_m = 3,
          .friction = {2.5, 4.5},
          .smooth_friction_slope_Ns_per_m = 0,
          .max_force_N = 50,
          .period_s = 1e-3,
          .encoder_resolution_m = 1e-6,
          .latency_ticks = 1,
          .position_tolerance_m = 3e-6};
}

// The axis of the scenes under the coast "pd": the same machine, stiffer and damped for it.
inline design::AxisDesign sprung_example() {
  design::AxisDesign axis = impulsive_example();
  axis.stiffness_N_per_m = 400;
  axis.approach_damping_Ns_per_m = 32;
  axis.kick_damping_Ns_per_m = 60;
  axis.position_tolerance_m = 1.8e-6;
  return axis;
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
