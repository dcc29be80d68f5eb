// The axis, drive and start of sim/scenarios/can_axis.toml for code that cannot read the file: an image that is its own
// machine. A test holds the two together.
#pragma once

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"

namespace breakaway::emulated {

inline constexpr double mass_kg = 1, start_m = -4, settle_tolerance_m = 3e-6;

inline model::FrictionBounds friction_bounds() { return model::bounds_from_coefficients(mass_kg, 10, 0.25, 0.45); }

inline motion::Slide resting_axis() {
  auto shape = model::shape::mean({0.5, 0.5}, [] {
    std::vector<model::ShapePtr> parts;
    parts.push_back(model::shape::stribeck(2));
    parts.push_back(model::shape::sine_in_time(4));
    return parts;
  }());
  return {mass_kg, {friction_bounds(), std::move(shape)}, {0, start_m, 0}};
}

inline drive_emulator::EmulatorConfig drive_config() {
  drive_emulator::EmulatorConfig c;
  c.rated_torque_mNm = 500;
  c.rated_current_mA = 2000;
  c.max_torque_per_mille = 2000;
  c.force_per_torque_N_per_Nm = 50;
  c.encoder_resolution_m = 1e-6;
  c.current_loop_time_constant_s = 1e-4;
  return c;
}

}  // namespace breakaway::emulated
