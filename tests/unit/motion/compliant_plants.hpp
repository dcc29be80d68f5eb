// Plants beyond the rigid axis, and a law of friction, that several tests move.
#pragma once

#include "breakaway/model/compliant_plant.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"

namespace breakaway::motion {

constexpr double period_s = 1e-3;

inline model::FrictionLaw stribeck_law() { return {{2.5, 4.5}, model::shape::stribeck(0.02)}; }

inline model::CompliantPlant with_load(double stiffness_N_per_m, double damping_Ns_per_m, double gap_m = 0) {
  model::CompliantPlant plant{.mass_kg = 0.4};
  plant.load.emplace(model::FlexibleLoad{0.6, {stiffness_N_per_m, damping_Ns_per_m, gap_m}, {}});
  return plant;
}

}  // namespace breakaway::motion
