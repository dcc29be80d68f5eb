// [told]: the node is made from what it is told, and the world keeps the truth.
#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "two_axes.hpp"

namespace breakaway::config {
namespace {

using breakaway::testing::refusal;
using testing::two_axes;
using testing::with;

std::string with_told(const std::string& lines) {
  return with(two_axes, "[axis.limits]\n", "[axis.told]\n" + lines + "\n[axis.limits]\n");
}

const std::string everything =
    "mass_kg = 1.25\nforce_gain = 1.1\nfriction_lower_N = 2\nfriction_upper_N = 5\nlatency_periods = 2";

TEST(Told, IsWhatTheNodeIsMadeFrom) {
  const Node node = parse_node(with_told(everything), "node.toml");
  const auto p = axis_parameters<double>(node, node.axes[0]);
  EXPECT_EQ(p.mass_kg, 1.25);
  EXPECT_EQ(p.friction.lower_N, 2);
  EXPECT_EQ(p.friction.upper_N, 5);
  EXPECT_EQ(p.latency_periods, 2);
  EXPECT_DOUBLE_EQ(node.axes[0].drive->force_per_torque_N_per_Nm, 55);
  EXPECT_EQ(axis_design(node, node.axes[0]).latency_ticks, 2);
  const auto flashed_node = flashed<float>(node);
  EXPECT_EQ(flashed_node.axes[0].law.mass_kg, 1.25F);
}

TEST(Told, LeavesTheWorldAsItIs) {
  const scenario::Scenario s = scenario::parse_scenario(with_told(everything), "node.toml");
  EXPECT_EQ(truth_of(s.node.axes[0]).mass_kg, 1);
  EXPECT_EQ(s.worlds[0].friction.bounds().lower_N, 2.5);
  EXPECT_EQ(s.worlds[0].friction.bounds().upper_N, 4.5);
  EXPECT_EQ(s.worlds[0].drive->force_per_torque_N_per_Nm, 50);
}

TEST(Told, IsSaidInOneLine) {
  const Node node = parse_node(with_told(everything), "node.toml");
  EXPECT_EQ(
      told_otherwise(node.axes[0]),
      "mass_kg 1.25 (truly 1), force_gain 1.1 (truly 1), friction_lower_N 2 (truly 2.5), friction_upper_N 5 (truly "
      "4.5), latency_periods 2 (truly 1)");
  EXPECT_EQ(told_otherwise(node.axes[1]), "");
}

TEST(Told, TheTruthChangesNothing) {
  const Node plain = parse_node(two_axes, "node.toml"), told = parse_node(with_told("mass_kg = 1"), "node.toml");
  EXPECT_EQ(flashed<float>(plain).checksum, flashed<float>(told).checksum);
  EXPECT_EQ(told_otherwise(told.axes[0]), "");
}

TEST(Told, IsRefusedInOneLineWhereItCannotBe) {
  const auto message = [](const std::string& lines) {
    return refusal([&] { parse_node(with_told(lines), "node.toml"); });
  };
  EXPECT_NE(message("friction_lower_N = 6").find("friction_lower_N makes a lower bound of 6 N above"),
            std::string::npos);
  EXPECT_NE(message("mass_kg = 0").find("mass_kg"), std::string::npos);
  EXPECT_NE(message("latency_periods = 9").find("latency_periods"), std::string::npos);
  EXPECT_NE(message("mass = 2").find("mass_kg"), std::string::npos) << message("mass = 2");
  // Gains are judged with the mass that is told: 2 sqrt(400 x 4) N s/m is above k22.
  EXPECT_NE(message("mass_kg = 4").find("k22_Ns_per_m"), std::string::npos) << message("mass_kg = 4");
}

}  // namespace
}  // namespace breakaway::config
