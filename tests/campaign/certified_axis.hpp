// A random axis as `design` is asked for it, and what it says.
#pragma once

#include "breakaway/design/report.hpp"
#include "random_braked_axis.hpp"

namespace breakaway::campaign {

// What is asked of any coast. max_approach_speed_m_s is left out: axes that are refused for it alone are run as well.
inline design::AxisDesign rigid_part_of(const BrakedClass& c, double tolerance_m) {
  const auto p = parameters(c, tolerance_m);
  return {.mass_kg = static_cast<double>(p.mass_kg),
          .stiffness_N_per_m = static_cast<double>(p.stiffness_N_per_m),
          .approach_damping_Ns_per_m = static_cast<double>(p.approach_damping_Ns_per_m),
          .kick_damping_Ns_per_m = static_cast<double>(p.kick_damping_Ns_per_m),
          .friction = c.friction,
          .max_force_N = c.max_force_N,
          .period_s = c.period_s,
          .encoder_resolution_m = c.encoder_resolution_m,
          .latency_ticks = c.latency_periods,
          .position_tolerance_m = tolerance_m};
}

inline design::AxisDesign asked_of(const BrakedClass& c, double tolerance_m) {
  design::AxisDesign asked = rigid_part_of(c, tolerance_m);
  asked.braked = c;
  return asked;
}

inline design::DesignReport report_of(const BrakedClass& c, double tolerance_m) {
  return design::design_axis(asked_of(c, tolerance_m));
}

}  // namespace breakaway::campaign
