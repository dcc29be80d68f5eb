// [uncertainty] and the coast "brake" in a file.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/parse_toml.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/pd_kicks.hpp"
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
  const auto pulses =
      design::design_pd_kicks(flashed_node.axes[1].law, node.axes[1].drive->current_loop_time_constant_s).table;
  EXPECT_EQ(flashed_node.axes[1].kicks.table.count, pulses.count);
  EXPECT_EQ(flashed_node.axes[1].kicks.table.entries[3].a0, pulses.entries[3].a0);
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

// Friction of 2.5 N holds nothing of 40 N, until a drive behind a slow current loop gives them.
std::string carried(const std::string& limits, const std::string& uncertainty = "force_N = 0.5") {
  std::string text = with(braked(uncertainty), "max_force_N = 50", "max_force_N = 50\nfeedforward_N = 40");
  text = with(text, "[axis.drive]\n", "[axis.drive]\ncurrent_loop_time_constant_s = 2e-3\n");
  text = with(text, "position_tolerance_m = 1.8e-6", "position_tolerance_m = 1e-4");
  text = with(text, "mass_kg = 1\n", "mass_kg = 1\nforce_N = -40\n");
  return with(text, "[axis.limits]\n", "[axis.limits]\n" + limits);
}

TEST(Feedforward, SagsNoFurtherThanItsLimitsLeaveRoomFor) {
  const Node node = parse_node(carried(""), "a.toml");
  const design::AxisDesign design = axis_design(node, node.axes[0]);
  // From the momentum that 40.5 N give before friction of 2 N exceeds what is lacking, and which friction takes away.
  const double until_s = 0.002 + 0.002 * std::log(40.5 / 2), push_Ns = 40.5 * 0.004 - 2 * until_s;
  EXPECT_NEAR(design.sag_m, push_Ns * until_s + push_Ns * push_Ns / 4, 1e-12);
  const auto reports = examine(node);
  ASSERT_TRUE(reports[0].certified) << reports[0].reasons.front();
  EXPECT_NE(reports[0].conditions.back().find("feedforward_N"), std::string::npos);
  const auto message = [](const std::string& limits) {
    return refusal([&] { examine(parse_node(carried(limits + "\n"), "a.toml")); });
  };
  EXPECT_NE(message("position_min_m = -0.004\nposition_max_m = 10").find("are 0.004 m from the target"),
            std::string::npos)
      << message("position_min_m = -0.004\nposition_max_m = 10");
  EXPECT_EQ(message("position_min_m = -10\nposition_max_m = 0.1"), "") << "it falls the other way";
  EXPECT_NE(message("position_m = 10\nfollowing_error_m = 0.004").find("following_error_m is 0.004"),
            std::string::npos);
}

// An approach that begins near its target may go further beyond it than it was away.
TEST(Brake, IsLeftTheWayBeyondATargetByTheFollowingError) {
  const auto examined = [](double following_error_m) {
    std::string text = with(braked(), "position_tolerance_m = 1.8e-6", "position_tolerance_m = 1e-5");
    text =
        with(text, "[axis.limits]\n", "[axis.limits]\nfollowing_error_m = " + std::to_string(following_error_m) + "\n");
    return examine(parse_node(text, "a.toml"));
  };
  const double beyond_m = examined(1)[0].braked->approach_beyond_m;
  ASSERT_GT(beyond_m, 2e-5);
  EXPECT_TRUE(examined(1.1 * beyond_m)[0].certified);
  EXPECT_NE(refusal([&] { examined(0.9 * beyond_m); }).find("an approach may go"), std::string::npos);
}

TEST(Feedforward, ThatFrictionHoldsSagsNowhere) {
  const Node node = parse_node(with(braked(), "max_force_N = 50", "max_force_N = 50\nfeedforward_N = 2"), "a.toml");
  EXPECT_EQ(axis_design(node, node.axes[0]).sag_m, 0);
}

TEST(Force, OfADriveThatCountsInItsLargestTorqueIsWholePerMilleOfTheRatedOne) {
  const auto relative = [](const std::string& force) {
    const std::string text =
        with(braked(), "rated_torque_Nm = 0.5", "rated_torque_Nm = 500\ntorque_relative_to = \"max\"");
    return with(with(text, "max_torque_per_mille = 2000", "max_torque_per_mille = 3"), "max_force_N = 50", force);
  };
  const Node node = parse_node(relative("max_force_N = 70"), "a.toml");  // 25 N each
  EXPECT_DOUBLE_EQ(max_force_N(node.axes[0]), 50);
  EXPECT_DOUBLE_EQ(force_step_N(node.axes[0]), 0.05);
  EXPECT_DOUBLE_EQ(braked_class(node, node.axes[0]).max_force_N, 50);
  EXPECT_NE(refusal([&] { parse_node(relative("max_force_N = 24"), "a.toml"); }).find("comes to 0 N"),
            std::string::npos);
}

TEST(Force, BelowOneStepOfTheDriveIsRefused) {
  const std::string coarse = with(with(braked(), "rated_torque_Nm = 0.5", "rated_torque_Nm = 2000"),
                                  "max_torque_per_mille = 2000", "max_torque_per_mille = 1");
  EXPECT_NE(refusal([&] { parse_node(coarse, "a.toml"); }).find("steps of 100 N"), std::string::npos);
}

// The law's share and the feedforward, each rounded to a float, add up to an ulp more than the limit is.
TEST(Force, OfTheLawAndTheFeedforwardTogetherIsNotAboveTheLimitInFloat) {
  for (const char* force : {"20.05", "20.175", "20.3", "21.05"}) {
    const std::string limit = std::string{"max_force_N = "} + force;
    const Node node =
        parse_node(with(braked("force_N = 0.5"), "max_force_N = 50", limit + "\nfeedforward_N = 0.6"), "a.toml");
    const auto p = axis_parameters<float>(node, node.axes[0]);
    EXPECT_LE(p.total_force_N(), static_cast<float>(max_force_N(node.axes[0]))) << force;
    EXPECT_NEAR(p.max_force_N, law_force_N(node.axes[0]), 1e-5) << force;
  }
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
