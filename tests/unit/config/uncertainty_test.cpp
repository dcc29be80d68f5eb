// [uncertainty] and the coast "brake" in a file.
#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/config/read_node.hpp"
#include "two_axes.hpp"

namespace breakaway::config {
namespace {

using breakaway::testing::refusal;
using testing::two_axes;
using testing::with;

// The first axis under the brake, with these lines in its [uncertainty].
std::string braked(const std::string& lines = {}) {
  const std::string coast = with(two_axes, "coast = \"pd\"", "coast = \"brake\"");
  return with(coast, "[axis.limits]\n", "[axis.uncertainty]\n" + lines + "\n[axis.limits]\n");
}

TEST(Uncertainty, WidensTheAxesThatKicksAreMadeFor) {
  const std::string lines = "mass = 0.1\nforce_gain = 0.05\nforce_N = 0.2\ncurrent_loop_time_constant = 0.2";
  const Node node = parse_node(
      with(braked(lines), "[axis.drive]\n", "[axis.drive]\ncurrent_loop_time_constant_s = 5e-4\n"), "node.toml");
  const design::BrakedClass c = braked_class(node, node.axes[0]);
  const double mass_kg = node.axes[0].mass_kg, lag_s = 5e-4;
  EXPECT_DOUBLE_EQ(c.mass_kg.least, 0.9 * mass_kg);
  EXPECT_DOUBLE_EQ(c.mass_kg.most, 1.1 * mass_kg);
  EXPECT_DOUBLE_EQ(c.force_gain.least, 0.95);
  EXPECT_DOUBLE_EQ(c.force_gain.most, 1.05);
  EXPECT_EQ(c.load_N, 0.2);
  EXPECT_DOUBLE_EQ(c.lag_s.least, 0.8 * lag_s);
  EXPECT_DOUBLE_EQ(c.lag_s.most, 1.2 * lag_s);
}

TEST(Uncertainty, IsRefusedByNameWhereNothingHoldsTheAxis) {
  const std::string error = refusal([] { parse_node(braked("force_N = 100"), "node.toml"); });
  EXPECT_NE(error.find("force_N"), std::string::npos);
  EXPECT_NE(error.find("feed a known force forward"), std::string::npos);
}

TEST(Uncertainty, IsNamedBesideSeveralAxes) {
  const std::string beside = with(two_axes, "[run]\n", "[uncertainty]\nmass = 0.1\n[run]\n");
  EXPECT_NE(refusal([&] { parse_node(beside, "node.toml"); }).find("uncertainty stands beside [[axis]]"),
            std::string::npos);
}

TEST(Brake, IsFlashedWithTheVeryTableThatIsCertified) {
  const Node node = parse_node(braked(), "node.toml");
  const auto flashed_node = flashed<float>(node);
  const auto design = design::design_braked_kicks<float>(braked_class(node, node.axes[0]));
  EXPECT_EQ(flashed_node.axes[0].law.coast, law::Coast::brake);
  EXPECT_EQ(flashed_node.axes[0].kicks.table.count, design.kicks.table.count);
  EXPECT_EQ(flashed_node.axes[0].kicks.table.entries[3].a0, design.kicks.table.entries[3].a0);
  EXPECT_EQ(flashed_node.axes[1].law.coast, law::Coast::pd);
  EXPECT_EQ(flashed_node.axes[1].kicks.table.count, 0);
}

TEST(Brake, IsTheCoastOfAFileThatNamesNone) {
  const Node node = parse_node(with(two_axes, "coast = \"pd\"\n", ""), "node.toml");
  EXPECT_EQ(node.axes[0].controller.impulsive->coast, law::Coast::brake);
  EXPECT_EQ(node.axes[1].controller.impulsive->coast, law::Coast::pd);
}

TEST(Brake, IsNotTheCoastOfTheNaiveKick) {
  const Node node = parse_node(with(two_axes, "coast = \"pd\"", "kick = \"naive\""), "node.toml");
  EXPECT_EQ(node.axes[0].controller.impulsive->coast, law::Coast::pd);
}

TEST(Feedforward, IsGivenInWholeStepsAndNotThereForTheLaw) {
  const Node node = parse_node(with(two_axes, "max_force_N = 50", "max_force_N = 50\nfeedforward_N = -9.81"), "a.toml");
  const Axis& axis = node.axes[0];
  const auto p = axis_parameters<float>(node, axis);
  EXPECT_FLOAT_EQ(p.feedforward_N, -9.8F) << "a step is 0.025 N";
  EXPECT_FLOAT_EQ(p.max_force_N, 50 - 9.8F);
  EXPECT_FLOAT_EQ(p.total_force_N(), 50);
  EXPECT_EQ(flashed<float>(node).axes[0].scale().max_force_N, p.total_force_N());
}

TEST(Feedforward, IsRefusedWhereItLeavesTooLittleOrNoDriveGivesIt) {
  const auto message = [](const std::string& text) { return refusal([&] { parse_node(text, "a.toml"); }); };
  const std::string most = with(two_axes, "max_force_N = 50", "max_force_N = 50\nfeedforward_N = 46");
  EXPECT_NE(message(most).find("leaves 4 N, not above"), std::string::npos) << message(most);
  const std::string ideal =
      "[plant]\nmass_kg = 1\n[friction]\nlower_N = 2.5\nupper_N = 4.5\n[controller]\nk1_N_per_m = 1\n"
      "k21_Ns_per_m = 0.8\nk22_Ns_per_m = 3\nfeedforward_N = 1\n";
  EXPECT_NE(message(ideal).find("give the axis a [drive]"), std::string::npos) << message(ideal);
}

// It uses all the force there is, and the supervisor stops what is faster than its limit.
TEST(Brake, ApproachesBelowTheSpeedLimit) {
  const std::string free = with(braked(), "max_approach_speed_m_s = 5\n", "");
  const Node node = parse_node(free, "node.toml");
  EXPECT_FLOAT_EQ(axis_parameters<float>(node, node.axes[0]).max_approach_speed_m_s, 0.9F * 20);
  EXPECT_FLOAT_EQ(axis_parameters<float>(node, node.axes[1]).max_approach_speed_m_s, 5) << "the file asks for less";
}

TEST(CoastPd, ApproachesBelowTheSpeedLimit) {
  const std::string free = with(two_axes, "max_approach_speed_m_s = 5\n", "");
  const Node node = parse_node(free, "node.toml");
  EXPECT_FLOAT_EQ(axis_parameters<float>(node, node.axes[0]).max_approach_speed_m_s, 0.9F * 20);
  EXPECT_FLOAT_EQ(axis_parameters<float>(node, node.axes[1]).max_approach_speed_m_s, 5) << "the file asks for less";
}

TEST(Brake, NeedsALoopAndADrive) {
  const std::string ideal =
      "[plant]\nmass_kg = 1\n[friction]\nlower_N = 2.5\nupper_N = 4.5\n[controller]\nk1_N_per_m = 1\n"
      "k21_Ns_per_m = 0.8\nk22_Ns_per_m = 3\ncoast = \"brake\"\n";
  EXPECT_NE(refusal([&] { parse_node(ideal, "node.toml"); }).find("give the axis a [drive]"), std::string::npos);
  const std::string drive =
      "[drive]\nrated_torque_Nm = 0.5\nmax_torque_per_mille = 2000\nforce_per_torque_N_per_Nm = 50\n"
      "encoder_resolution_m = 1e-6\n";
  EXPECT_NE(refusal([&] { parse_node(ideal + drive, "node.toml"); }).find("which takes whole periods of a [loop]"),
            std::string::npos);
}

}  // namespace
}  // namespace breakaway::config
