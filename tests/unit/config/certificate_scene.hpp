// The file of an axis that the tests of its certificate spoil.
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "two_axes.hpp"

namespace breakaway::config {

using breakaway::testing::refusal;
using testing::with;

using testing::with;

// Every table of an axis, with a line that more can be put behind.
inline const std::string scene = R"(
[loop]
period_s = 0.001
[bus]
bit_rate = 1_000_000
[plant]
mass_kg = 1
[friction]
lower_N = 2.5
upper_N = 4.5
[told]
[uncertainty]
mass = 0.02
force_gain = 0.02
force_N = 0.3
current_loop_time_constant = 0.2
[controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 60
kick = "two_phase"
coast = "brake"
max_force_N = 48
max_approach_speed_m_s = 5
position_tolerance_m = 5e-6
target_m = 0
[limits]
position_m = 1
speed_m_s = 20
force_N = 60
following_error_m = 2
[move]
distance_m = 0.4
speed_m_s = 1
acceleration_m_s2 = 20
jerk_m_s3 = 2000
[drive]
rated_torque_Nm = 0.5
max_torque_per_mille = 2000
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
current_loop_time_constant_s = 1e-4
[run]
duration_s = 1
)";

inline std::string joined(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts) all += part;
  return all;
}

// More lines in a table.
inline std::string more(const std::string& table, const std::string& lines, const std::string& text = scene) {
  return with(text, joined({table, "\n"}), joined({table, "\n", lines, "\n"}));
}

inline std::string under_pd(std::string text = scene) {
  text = with(text, "coast = \"brake\"", "coast = \"pd\"");
  const auto move = text.find("[move]");
  text.erase(move, text.find("[drive]") - move);
  for (const char* line :
       {"mass = 0.02\n", "force_gain = 0.02\n", "force_N = 0.3\n", "current_loop_time_constant = 0.2\n"})
    text = with(text, line, "");
  return text;
}

// Why the axis is not certified; empty where it is. The simulation must be able to read what the node reads.
inline std::string why_not(const std::string& text) {
  const Node node = scenario::parse_scenario(text, "axis.toml").node;
  const Node alone = parse_node(text, "axis.toml");
  const auto report = examine(node).front();
  EXPECT_EQ(report.reasons, examine(alone).front().reasons);
  return report.certified ? "" : report.reasons.front();
}

inline void expect_refused(const std::string& text, const std::string& named) {
  EXPECT_NE(why_not(text).find(named), std::string::npos) << named << ": " << why_not(text);
}

}  // namespace breakaway::config
