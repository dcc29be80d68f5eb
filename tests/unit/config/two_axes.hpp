// The text of a node with two axes that is certified, and ways to spoil it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"

namespace breakaway::config::testing {

inline std::string axis_text(const std::string& name, int node_id) {
  return "[[axis]]\nname = \"" + name + R"("
[axis.plant]
mass_kg = 1
[axis.friction]
lower_N = 2.5
upper_N = 4.5
[axis.controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 60
coast = "pd"
max_force_N = 50
max_approach_speed_m_s = 5
position_tolerance_m = 1.8e-6
[axis.limits]
speed_m_s = 20
[axis.drive]
node_id = )" +
         std::to_string(node_id) +
         R"(
rated_torque_Nm = 0.5
max_torque_per_mille = 2000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
)";
}

inline const std::string two_axes = "[loop]\nperiod_s = 0.001\n[bus]\nbit_rate = 1_000_000\n[run]\nduration_s = 1\n" +
                                    axis_text("x", 1) + axis_text("y", 2);

// The first place that reads `from` reads `to`.
inline std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

inline AnyNode<float> certified_node(const std::string& text = two_axes) {
  const Node node = parse_node(text, "node.toml");
  return certified(node, examine(node));
}

// What an image with room for two axes holds.
inline firmware::FlashedNode<float, 2> flashed_pair() {
  const AnyNode<float> any = certified_node();
  return {.loop = any.loop, .count = any.count, .axes = {any.axes[0], any.axes[1]}, .checksum = any.checksum};
}

}  // namespace breakaway::config::testing
