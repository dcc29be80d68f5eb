// The axes, drives and starts of sim/scenarios/two_axes.toml for code that cannot read the file: an image that is its
// own machine. A test holds the two together.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/model/friction_law.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"
#include "breakaway/sil/braked_slide.hpp"

namespace breakaway::emulated {

inline constexpr double settle_tolerance_m = 3e-6;

struct WorldAxis {
  double mass_kg;
  double start_m;
  law::FrictionBounds<double> friction;
  sil::Mounting mounting;
};

inline constexpr std::array<WorldAxis, 2> world_axes{
    {{1, -4, {2.5, 4.5}, sil::Mounting::straight}, {3, 0.5, {6, 10}, sil::Mounting::inverted}}};

inline model::ShapePtr friction_shape(std::size_t axis) {
  if (axis == 1) return model::shape::static_kinetic(1, 0.2);
  std::vector<model::ShapePtr> parts;
  parts.push_back(model::shape::stribeck(2));
  parts.push_back(model::shape::sine_in_time(4));
  return model::shape::mean({0.5, 0.5}, std::move(parts));
}

inline motion::Slide resting_axis(std::size_t axis) {
  const WorldAxis& a = world_axes[axis];
  return {a.mass_kg, {a.friction, friction_shape(axis)}, {0, a.start_m, 0}};
}

inline drive_emulator::EmulatorConfig drive_config(std::size_t axis) {
  drive_emulator::EmulatorConfig c;
  c.node_id = static_cast<std::uint8_t>(axis + 1);
  c.rated_torque_mNm = axis == 0 ? 500 : 400;
  c.rated_current_mA = axis == 0 ? 2000 : 3000;
  c.max_torque_per_mille = 2000;
  c.force_per_torque_N_per_Nm = axis == 0 ? 50 : 157.07963267948966;
  c.encoder_resolution_m = 1e-6;
  c.current_loop_time_constant_s = 1e-4;
  return c;
}

}  // namespace breakaway::emulated
