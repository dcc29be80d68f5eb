// A certificate takes in everything that a file says, or is refused.
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <utility>

#include "../number_after.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "certificate_scene.hpp"

namespace breakaway::config {
namespace {

using breakaway::testing::number_after;
using breakaway::testing::word_after;

TEST(Certificate, IsGivenToTheSceneThatTheseTestsSpoil) {
  EXPECT_EQ(why_not(scene), "");
  EXPECT_EQ(why_not(under_pd()), "");
}

TEST(Certificate, RefusesByNameWhatIsNoRigidAxisOnFrictionThatHolds) {
  const std::string load = "load = { mass_kg = 1, stiffness_N_per_m = 1e6 }";
  for (const std::string& text : {scene, under_pd()}) {
    expect_refused(more("[plant]", load, text), "[plant] load: ");
    expect_refused(more("[plant]", joined({load, "\nbacklash = { gap_m = 1e-5 }"}), text), "[plant] backlash: ");
    expect_refused(more("[plant]", "presliding = { stiffness_N_per_m = 1e7 }", text), "[plant] presliding: ");
    expect_refused(more("[plant]", "encoder_error = { noise_m = 1e-7 }", text), "[plant] encoder_error: ");
    EXPECT_EQ(why_not(more("[plant]", "encoder_error = { noise_m = 0 }", text)), "");
  }
}

// Without limits of a move, which are certified for a loop without jitter only.
TEST(Certificate, TakesNoiseAndJitterInUpToTheStatedBounds) {
  std::string still = scene;
  const auto move = still.find("[move]");
  still.erase(move, still.find("[drive]") - move);
  still = with(still, "position_tolerance_m = 5e-6", "position_tolerance_m = 5e-5");
  const std::string noisy = more("[uncertainty]", "encoder_noise_m = 1e-6", still);
  EXPECT_EQ(why_not(more("[plant]", "encoder_error = { noise_m = 1.6e-7 }", noisy)), "");
  expect_refused(more("[plant]", "encoder_error = { noise_m = 1.7e-7 }", noisy), "[uncertainty] encoder_noise_m");
  const std::string shaken = more("[uncertainty]", "jitter_s = 1e-4", still);
  EXPECT_EQ(why_not(more("[bus]", "delay_max_s = 1e-4", shaken)), "");
  expect_refused(more("[bus]", "delay_max_s = 1.1e-4", shaken), "jitter_s = 0.0001 is less");
  expect_refused(more("[uncertainty]", "jitter_s = 1e-4"), "move_keeps_time");
  EXPECT_NE(refusal([&] {
              parse_node(more("[uncertainty]", "jitter_s = 6e-4", still), "axis.toml");
            }).find("more than half the period"),
            std::string::npos);
}

// Bristles of 1e7 N/m on an axis that is told of at least this stiffness.
std::string bending(const std::string& told, const std::string& plant = "presliding = { stiffness_N_per_m = 1e7 }") {
  const std::string key = told.empty() ? "" : joined({"presliding_stiffness_N_per_m = ", told});
  const std::string stiff = more("[friction]", key, more("[plant]", plant));
  return with(stiff, "force_N = 0.3\n", "force_N = 0.2\n");
}

TEST(Certificate, TakesInFrictionThatBendsWhereItIsToldHowStiffItIsAtLeast) {
  EXPECT_EQ(why_not(bending("1e7")), "");
  EXPECT_EQ(why_not(bending("1e6")), "");
  EXPECT_EQ(why_not(bending("1e7", "")), "") << "what holds at once is stiffer than any bound";
  expect_refused(bending(""), "state [friction] presliding_stiffness_N_per_m = 1e+07");
  expect_refused(bending("1.1e7"), "is below [friction] presliding_stiffness_N_per_m = 1.1e+07; lower that");
  expect_refused(bending("1e7", "presliding = { stiffness_N_per_m = 1e7, damping_Ns_per_m = 6400 }"),
                 "damping_Ns_per_m = 6400 is above");
}

// Numbers of more digits than sentences have: what is named as enough, typed in, is.
TEST(Certificate, TakesTheVeryNumbersThatItNames) {
  for (const char* digits : {"1.23456749", "2.34567851", "3.45678949"}) {
    const std::string bristles = joined({"presliding = { stiffness_N_per_m = ", digits, "e7 }"});
    const std::string stiffness = word_after(why_not(bending("", bristles)), "presliding_stiffness_N_per_m = ");
    EXPECT_EQ(why_not(bending(stiffness, bristles)), "") << digits;
    const std::string rising =
        joined({"law = { kind = \"complement\", part = { kind = \"stribeck\", velocity_m_s = ", digits, " } }"});
    const std::string slope = word_after(why_not(more("[friction]", rising, under_pd())), "rises with speed, by ");
    EXPECT_EQ(why_not(more("[friction]", joined({rising, "\nsmooth_slope_Ns_per_m = ", slope}), under_pd())), "");
  }
}

// What is certified must be what `simulate` and `study` run: one reader refuses it for all of them.
TEST(Certificate, RefusesBristlesThatTheSimulationRefusesInTheSameWords) {
  for (const char* bristles : {"stiffness_N_per_m = 1e7, damping_Ns_per_m = 1, model = \"dahl\"",
                               "stiffness_N_per_m = 2e10", "stiffness_N_per_m = 1e7, width_m = 1"}) {
    const std::string text = bending("1e7", joined({"presliding = { ", bristles, " }"}));
    const std::string of_design = refusal([&] { parse_node(text, "axis.toml"); });
    EXPECT_NE(of_design.find("[plant.presliding]"), std::string::npos) << bristles << ": " << of_design;
    EXPECT_EQ(of_design, refusal([&] { scenario::parse_scenario(text, "axis.toml"); }));
  }
}

TEST(Certificate, NamesWhatIsSimulatedButNotCertifiedOfFrictionThatBends) {
  expect_refused(bending("6e4"), "bending_is_few_counts");
  const std::string lag = "current_loop_time_constant_s = ";
  const std::string wide = with(bending("1e7"), "position_tolerance_m = 5e-6", "position_tolerance_m = 8e-6");
  expect_refused(with(wide, joined({lag, "1e-4"}), joined({lag, "3e-4"})), "bending_loop_is_fast");
  expect_refused(with(bending("1e7"), "force_N = 0.2\n", "force_N = 0.3\n"), "bending_load_is_small");
  expect_refused(with(bending("1e7"), "upper_N = 4.5", "upper_N = 3"), "bending_bounds_are_apart");
}

TEST(Certificate, PromisesTheFloorAndNotTheToleranceUnderTheFineStage) {
  const std::string below = with(scene, "position_tolerance_m = 5e-6", "position_tolerance_m = 1e-6");
  expect_refused(below, "tolerance_above_floor");
  const std::string fine = more("[run]", "settle_tolerance_m = 9e-6", below);
  EXPECT_EQ(why_not(fine), "");
  expect_refused(more("[controller]", "fine_stage = false", fine), "tolerance_above_floor");
  expect_refused(more("[run]", "settle_tolerance_m = 3e-6", below), "tolerance_above_floor");
  const auto promise = *examine(parse_node(fine, "axis.toml")).front().braked;
  EXPECT_DOUBLE_EQ(promise.error_m, promise.least_tolerance_m + 0.5e-6);
  EXPECT_DOUBLE_EQ(promise.beyond_m, 1.35 * promise.least_tolerance_m + 0.5e-6);
}

TEST(Certificate, RefusesAFineStageUnderTheCoastPd) {
  const std::string error =
      refusal([&] { parse_node(more("[controller]", "fine_stage = false", under_pd()), "a.toml"); });
  EXPECT_NE(error.find("fine_stage"), std::string::npos) << error;
  EXPECT_NE(error.find("set coast = \"brake\""), std::string::npos) << error;
}

TEST(Certificate, RefusesToTellTheCoastPdOfFrictionThatBends) {
  const std::string text = more("[friction]", "presliding_stiffness_N_per_m = 1e7", under_pd());
  const std::string error = refusal([&] { parse_node(text, "axis.toml"); });
  EXPECT_NE(error.find("set [controller] coast = \"brake\""), std::string::npos) << error;
}

std::string without_move() {
  std::string text = scene;
  const auto move = text.find("[move]");
  return text.erase(move, text.find("[drive]") - move);
}

TEST(Certificate, IsRefusedWhereTheApproachMayNotBeFastEnoughToGetOn) {
  const std::string text = without_move(), slow = with(text, "approach_speed_m_s = 5", "approach_speed_m_s = 0.005");
  EXPECT_EQ(why_not(text), "");
  expect_refused(slow, "approach_gets_on");
}

TEST(Certificate, IsRefusedUnderTheCoastPdWhereTheSpeedLimitLeavesTheApproachTooSlow) {
  const std::string slack = with(under_pd(), "k21_Ns_per_m = 32", "k21_Ns_per_m = 7.5");
  const std::string free = with(slack, "max_approach_speed_m_s = 5\n", "");
  EXPECT_EQ(why_not(with(free, "speed_m_s = 20", "speed_m_s = 0.9")), "");
  expect_refused(with(free, "speed_m_s = 20", "speed_m_s = 0.76"), "nine tenths of [limits] speed_m_s");
}

TEST(Certificate, TakesForcesBesideTheDrivesInUnderTheBrakeUpToTheStatedBound) {
  EXPECT_EQ(why_not(more("[plant]", "force_N = -0.3")), "");
  expect_refused(more("[plant]", "force_N = -0.31"), "raise that");
  EXPECT_EQ(why_not(more("[plant]", "force_N = 0.1\ncogging = { amplitude_N = 0.2, period_m = 1e-3 }")), "");
  expect_refused(more("[plant]", "force_N = 0.1\ncogging = { amplitude_N = 0.21, period_m = 1e-3 }"), "0.31 N act");
  EXPECT_EQ(why_not(more("[plant]", "ripple = { share = 0.006, period_m = 1e-3 }")), "");
  expect_refused(more("[plant]", "ripple = { share = 0.007, period_m = 1e-3 }"), "0.336 N act");
  expect_refused(more("[plant]", "force_N = 0.01", under_pd()), "the coast \"pd\" knows nothing");
}

void expect_no_room(const std::string& text, const std::string& named) {
  const std::string said = refusal([&] { why_not(text); });
  EXPECT_NE(said.find(named), std::string::npos) << said;
}

// `simulate` shows 0.19 m past a target at 0 from -4.9 m under the least friction.
TEST(Certificate, LeavesRoomUnderTheCoastPdForWhatAnApproachGoesBeyond) {
  const std::string slack = with(under_pd(), "k21_Ns_per_m = 32", "k21_Ns_per_m = 8");
  const auto with_limits = [&](const std::string& limits) { return with(slack, "position_m = 1\n", limits + "\n"); };
  EXPECT_EQ(why_not(with_limits("position_min_m = -4.9\nposition_max_m = 0.21")), "");
  expect_no_room(with_limits("position_min_m = -4.9\nposition_max_m = 0.19"), "an approach may go 0.202 m beyond");
  expect_no_room(with(slack, "following_error_m = 2", "following_error_m = 0.1"), "beyond its target; raise it");
}

TEST(Certificate, LeavesTheFollowingErrorTheWayToTurnWhereTheTargetMoves) {
  const std::string moved = more("[controller]", "targets = [{ time_s = 0.2, position_m = -0.2 }]");
  EXPECT_EQ(why_not(with(moved, "following_error_m = 2", "following_error_m = 0.1")), "");
  expect_no_room(with(moved, "following_error_m = 2", "following_error_m = 0.04"), "before it turns");
  EXPECT_EQ(why_not(with(scene, "following_error_m = 2", "following_error_m = 0.04")), "") << "no target moves";
}

TEST(Certificate, IsRefusedWhereOneLostSampleStopsTheAxis) {
  expect_no_room(with(scene, "following_error_m = 2", "following_error_m = 2\nfeedback_timeout_s = 0.0015"),
                 "raise it to 0.0025");
  EXPECT_EQ(why_not(with(scene, "following_error_m = 2", "following_error_m = 2\nfeedback_timeout_s = 0.0025")), "");
}

TEST(Certificate, CountsWhatTheFeedforwardLeavesOfAKnownForce) {
  const std::string weight = more("[plant]", "force_N = -2");
  expect_refused(weight, "2 N act");
  // The force gain is off by as much as [uncertainty] says, and so is what is given against the weight.
  EXPECT_EQ(why_not(more("[controller]", "feedforward_N = 2", weight)), "");
  EXPECT_EQ(why_not(more("[controller]", "feedforward_N = 1.8", weight)), "");
  expect_refused(more("[controller]", "feedforward_N = 1.7", weight), "0.334 N act");
  expect_refused(more("[controller]", "feedforward_N = -2", weight), "4.04 N act");
  const std::string exact = more("[plant]", "force_N = -2", under_pd());
  EXPECT_EQ(why_not(more("[controller]", "feedforward_N = 2", exact)), "");
  expect_refused(more("[controller]", "feedforward_N = 2.03", exact), "0.025 N act");
}

TEST(Certificate, HoldsFrictionAgainstTheBoundsThatTheControllerIsTold) {
  const std::string drift = more("[plant]", "drift = { share = 0.1, period_s = 3 }");
  expect_refused(drift, "friction may be between 2.25 and 4.95 N");
  EXPECT_EQ(why_not(more("[told]", "friction_lower_N = 2.25\nfriction_upper_N = 4.95", drift)), "");
  expect_refused(more("[told]", "friction_lower_N = 2.6"), "outside the 2.6 to 4.5 N");
}

TEST(Certificate, HoldsWhatIsToldAgainstTheTruth) {
  EXPECT_EQ(why_not(more("[told]", "mass_kg = 1.01")), "");
  expect_refused(more("[told]", "mass_kg = 1.03"), "[told] mass_kg = 1.03 is truly 1");
  EXPECT_EQ(why_not(more("[told]", "force_gain = 0.99")), "");
  expect_refused(more("[told]", "force_gain = 1.05"), "[told] force_gain = 1");
  expect_refused(more("[told]", "latency_periods = 2"), "[told] latency_periods = 2");
  expect_refused(more("[told]", "mass_kg = 1.001", under_pd()), "nothing allows for that");
}

TEST(Certificate, OfTheCoastPdRefusesFrictionThatRisesWithSpeedUnlessItsSlopeIsStated) {
  const std::string rising = "law = { kind = \"complement\", part = { kind = \"stribeck\", velocity_m_s = 0.5 } }";
  expect_refused(more("[friction]", rising, under_pd()), "by 4 N s/m at its steepest");
  EXPECT_EQ(why_not(more("[friction]", joined({rising, "\nsmooth_slope_Ns_per_m = 4"}), under_pd())), "");
  EXPECT_EQ(why_not(more("[friction]", rising)), "") << "under the brake friction is free inside its bounds";
  const std::string falling =
      "law = { kind = \"mean\", parts = [{ kind = \"stribeck\", velocity_m_s = 2 }, { kind = "
      "\"sine_in_time\", angular_frequency_rad_s = 4 }] }";
  EXPECT_EQ(why_not(more("[friction]", falling, under_pd())), "");
  const std::string jump = "law = { kind = \"static_kinetic\", static_value = 0, kinetic_value = 1 }";
  expect_refused(more("[friction]", jump, under_pd()), "rises with speed");
  expect_refused(more("[friction]", "smooth_slope_Ns_per_m = 4"), "the coast \"brake\" does not know");
}

TEST(Certificate, RefusesKeysThatTheCoastIgnores) {
  expect_refused(more("[uncertainty]", "mass = 0.01", under_pd()), "[uncertainty] is stated");
  for (const std::string& text : {scene, under_pd()})
    expect_refused(with(text, "\"two_phase\"", "\"naive\""), "kick = \"naive\"");
}

TEST(Certificate, RefusesABusThatMakesKicksLongerOrReadingsLate) {
  expect_refused(more("[bus]", "loss_probability = 0.001"), "loss_probability");
  expect_refused(more("[bus]", "delay_max_s = 1e-5"), "[uncertainty] jitter_s = 0 is less");
  expect_refused(more("[bus]", "delay_max_s = 1e-5", under_pd()), "delay_max_s");
  EXPECT_EQ(why_not(more("[bus]", "delay_min_s = 1e-5\ndelay_max_s = 1e-5")), "");
  EXPECT_EQ(why_not(more("[drive]", "tpdo_delay_max_s = 4e-4")), "");
  expect_refused(more("[drive]", "tpdo_delay_max_s = 9e-4"), "too late for its period");
  expect_refused(more("[drive]", "tpdo_delay_min_s = 9e-4"), "too late for its period");
}

TEST(Certificate, ShowsByHowLittleASettleToleranceIsTooNarrow) {
  const std::string narrow = with(scene, "duration_s = 1", "duration_s = 1\nsettle_tolerance_m = 5.4999999e-6");
  const std::string said = refusal([&] { parse_node(narrow, "axis.toml"); });
  EXPECT_NE(said.find("is 5.4999999e-06, below"), std::string::npos) << said;
}

// A key that is written with the value that it has anyway changes nothing.
TEST(Certificate, CountsTheDelayOfADriveWhetherTheFileNamesItOrNot) {
  for (const char* period : {"0.00043", "0.00044", "0.00045"}) {
    const std::string text = with(scene, "period_s = 0.001", std::string{"period_s = "} + period);
    const std::string named = more("[drive]", "tpdo_delay_max_s = 2e-5", text);
    const auto late = [](const std::string& file) {
      return why_not(file).find("too late for its period") != std::string::npos;
    };
    EXPECT_EQ(late(text), period == std::string{"0.00043"});
    EXPECT_EQ(late(named), late(text)) << period;
    EXPECT_NEAR(least_period_s(parse_node(text, "axis.toml")), 0.00044, 1e-9);
  }
}

// The loop goes to a whole count, and `simulate` looks at the target.
TEST(Certificate, CountsHowFarATargetIsFromAWholeCount) {
  const std::string settles = with(scene, "duration_s = 1", "duration_s = 1\nsettle_tolerance_m = 5.6e-6");
  const auto why = [](const std::string& text) { return refusal([&] { parse_node(text, "axis.toml"); }); };
  EXPECT_EQ(why(settles), "");
  EXPECT_EQ(why(with(settles, "target_m = 0", "target_m = 0.123456")), "");
  const std::string between = why(with(settles, "target_m = 0", "target_m = 0.1234564"));
  EXPECT_NE(between.find("at 0.1234564 m; give 0.123456 m, which"), std::string::npos) << between;
  EXPECT_NE(why(with(settles, "target_m = 0",
                     "targets = [{ time_s = 1, position_m = 1e-7 }, { time_s = 2, position_m = "
                     "3e-7 }]"))
                .find("at 3e-07 m; give 0 m"),
            std::string::npos);
  EXPECT_EQ(why(with(with(settles, "5.6e-6", "6e-6"), "target_m = 0", "target_m = 0.1234564")), "");
}

// Without a [move], too.
TEST(Certificate, RefusesTargetsThatAnApproachMayPassOutOfTheTravel) {
  std::string text = scene;
  text.erase(text.find("[move]"), text.find("[drive]") - text.find("[move]"));
  EXPECT_EQ(why_not(with(text, "target_m = 0", "target_m = 0.99")), "");
  const std::string near = with(text, "target_m = 0", "target_m = 0.99999");
  EXPECT_NE(refusal([&] { examine(parse_node(near, "axis.toml")); }).find("an approach may go"), std::string::npos);
  // Limits that leave no target room, and what is said of them.
  const std::string narrow = with(text, "position_m = 1\n", "position_m = 1e-3\n");
  const std::string said = refusal([&] { examine(parse_node(narrow, "axis.toml")); });
  const auto at = said.find("widen them to ");
  ASSERT_NE(at, std::string::npos) << said;
  const std::string wide = said.substr(at + 14, said.find(' ', at + 14) - at - 14);
  EXPECT_EQ(why_not(with(text, "position_m = 1\n", "position_m = " + wide + "\n")), "") << wide;
}

std::string told_of(const std::string& text) {
  return refusal([&] { examine(parse_node(text, "axis.toml")); });
}

// The scene without its move, in other numbers.
std::string in_numbers(std::initializer_list<std::pair<const char*, const char*>> numbers) {
  std::string text = without_move();
  for (const auto& [was, is] : numbers) text = with(text, was, is);
  return text;
}

// An encoder of 0.2 mm shows late what a force gain that is off by a tenth makes of 130 g.
TEST(Certificate, AsksForASpeedLimitAboveWhatAnApproachMayReach) {
  const std::string coarse = in_numbers({{"mass_kg = 1\n", "mass_kg = 0.13\n"},
                                         {"k1_N_per_m = 400", "k1_N_per_m = 50"},
                                         {"k21_Ns_per_m = 32", "k21_Ns_per_m = 4"},
                                         {"lower_N = 2.5", "lower_N = 0.46"},
                                         {"upper_N = 4.5", "upper_N = 0.48"},
                                         {"force_N = 0.3\n", ""},
                                         {"force_gain = 0.02", "force_gain = 0.1"},
                                         {"max_force_N = 48", "max_force_N = 0.72"},
                                         {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.01"},
                                         {"encoder_resolution_m = 1e-6", "encoder_resolution_m = 2e-4"},
                                         {"position_tolerance_m = 5e-6", "position_tolerance_m = 4e-4"},
                                         {"max_approach_speed_m_s = 5", "max_approach_speed_m_s = 0.7"}});
  EXPECT_EQ(why_not(coarse), "");
  const auto limited = [&](const std::string& m_s) { return with(coarse, "\nspeed_m_s = 20", "\nspeed_m_s = " + m_s); };
  const std::string said = told_of(limited("0.75"));
  EXPECT_NE(said.find("an approach that is allowed 0.675 m/s may reach"), std::string::npos) << said;
  const std::string enough = limited(word_after(said, "raise it to "));
  const std::string speed = "max_approach_speed_m_s = " + word_after(said, "max_approach_speed_m_s = ");
  EXPECT_EQ(why_not(with(enough, "max_approach_speed_m_s = 0.7", speed)), "");
}

// Samples that come late in turn let an axis seem slower than it is.
TEST(Certificate, LeavesAnApproachLessOfItsSpeedLimitUnderJitter) {
  const std::string limited =
      with(with(without_move(), "max_approach_speed_m_s = 5\n", ""), "speed_m_s = 20", "speed_m_s = 8");
  const auto speed_m_s = [](const std::string& text) {
    const Node node = parse_node(text, "axis.toml");
    return axis_design(node, node.axes.front()).max_approach_speed_m_s;
  };
  EXPECT_DOUBLE_EQ(speed_m_s(limited), 0.9 * 8);
  EXPECT_DOUBLE_EQ(speed_m_s(more("[uncertainty]", "jitter_s = 2.5e-4", limited)), 0.9 * 8 / 1.25);
}

TEST(Certificate, OffersTargetsThatItTakes) {
  const std::string said = told_of(with(scene, "target_m = 0", "target_m = 0.99999"));
  const std::string least = word_after(said, "keep targets between ");
  const std::string most = word_after(said, joined({"between ", least, " and "}));
  for (const std::string& target : {least, most})
    EXPECT_EQ(why_not(with(scene, "target_m = 0", "target_m = " + target)), "") << target;
}

TEST(Certificate, OffersTargetsThatItTakesFarFromZeroAndBesideOneLimit) {
  const auto at = [](const std::string& limits, const std::string& target_m) {
    const std::string limited = with(scene, "\nposition_m = 1\n", "\n" + limits + "\n");
    return with(with(limited, "mass_kg = 1\n", "mass_kg = 1\nposition_m = " + target_m + "\n"), "target_m = 0",
                "target_m = " + target_m);
  };
  const std::string far = "position_min_m = 2146.71\nposition_max_m = 2147.2105";
  const std::string said = told_of(at(far, "2147.21"));
  EXPECT_NE(said.find("a target at 2147.21 m"), std::string::npos) << said;
  const std::string least = word_after(said, "keep targets between ");
  const std::string most = word_after(said, joined({"between ", least, " and "}));
  for (const std::string& target : {least, most}) EXPECT_EQ(why_not(at(far, target)), "") << target;
  EXPECT_LT(std::stod(most), 2147.2105);
  EXPECT_GT(std::stod(most), 2147.2) << "no more room is lost than has to be";

  const std::string below = word_after(told_of(at("position_max_m = 1", "1")), "keep targets below ");
  EXPECT_EQ(why_not(at("position_max_m = 1", below)), "") << below;
  const std::string above = word_after(told_of(at("position_min_m = -1", "-1")), "keep targets above ");
  EXPECT_EQ(why_not(at("position_min_m = -1", above)), "") << above;
}

// A weak drive moves 240 kg so slowly at first that a float tells nothing of it in what counts as standing.
TEST(Certificate, IsNotForWaysOverWhichAFloatTellsNoSlowAxisFromOneThatSticks) {
  const std::string heavy = in_numbers({{"mass_kg = 1\n", "mass_kg = 240\n"},
                                        {"k22_Ns_per_m = 60", "k22_Ns_per_m = 1000"},
                                        {"lower_N = 2.5", "lower_N = 2.34"},
                                        {"upper_N = 4.5", "upper_N = 2.35"},
                                        {"force_N = 0.3\n", ""},
                                        {"max_force_N = 48", "max_force_N = 4"},
                                        {"rated_torque_Nm = 0.5", "rated_torque_Nm = 0.1"},
                                        {"encoder_resolution_m = 1e-6", "encoder_resolution_m = 1e-7"}});
  EXPECT_EQ(why_not(heavy), "");
  const auto within = [&](const std::string& m) {
    return with(heavy, "\nposition_m = 1\n", "\nposition_m = " + m + "\n");
  };
  const std::string said = told_of(within("100"));
  EXPECT_NE(said.find("[limits] of position let a target be 200 m away"), std::string::npos) << said;
  const std::string near = std::to_string(0.49 * number_after(said, "is certified over "));
  EXPECT_EQ(why_not(within(near)), "") << near;
}

// Two kilometres away a float tells 0.1 m/s from one count a period by nothing, and a move at 0.5 m/s by 2 %.
TEST(Certificate, IsNotForWaysOverWhichAFloatHidesHowFastASlowApproachIs) {
  const std::string slow = in_numbers({{"max_approach_speed_m_s = 5", "max_approach_speed_m_s = 0.1"}});
  const std::string move = with(scene, "\nspeed_m_s = 1\n", "\nspeed_m_s = 0.5\n");
  for (const std::string& axis : {slow, move}) {
    const auto within = [&](double position_m) {
      return with(axis, "\nposition_m = 1\n", "\nposition_m = " + std::to_string(position_m) + "\n");
    };
    EXPECT_EQ(why_not(axis), "");
    const double most_m = number_after(told_of(within(1000)), "is certified over ");
    EXPECT_GT(most_m, 10) << "it is of no use";
    EXPECT_EQ(why_not(within(0.499 * most_m)), "");
    EXPECT_NE(told_of(within(0.501 * most_m)).find("allow more speed"), std::string::npos);
  }
  EXPECT_EQ(why_not(with(without_move(), "\nposition_m = 1\n", "\nposition_m = 1000\n")), "") << "at 5 m/s";
}

TEST(Certificate, RefusesMovesThatTheAxisOrItsLimitsCannotTake) {
  expect_refused(with(scene, "acceleration_m_s2 = 20", "acceleration_m_s2 = 4"), "move_can_be_made");
  expect_refused(with(scene, "jerk_m_s3 = 2000", "jerk_m_s3 = 5000"), "jerk_can_be_followed");
  expect_refused(with(scene, "mass = 0.02", "mass = 0.09"), "jerk_is_known");
  EXPECT_EQ(why_not(with(scene, "mass = 0.02", "mass = 0.075")), "");
  const auto with_torque_step = [](const char* rated_torque) {
    const std::string range = with(scene, "max_torque_per_mille = 2000", "max_torque_per_mille = 90");
    return with(range, "rated_torque_Nm = 0.5", rated_torque);
  };
  expect_refused(with_torque_step("rated_torque_Nm = 11.2"), "move_force_is_fine");
  EXPECT_EQ(why_not(with_torque_step("rated_torque_Nm = 10.8")), "");
  const auto message = [](const std::string& from, const std::string& to) {
    return refusal([&] { examine(parse_node(with(scene, from, to), "axis.toml")); });
  };
  EXPECT_NE(message("distance_m = 0.4", "distance_m = 3").find("between the [limits]"), std::string::npos);
  EXPECT_NE(message("target_m = 0", "target_m = 0.99999").find("keep targets between"), std::string::npos);
  const std::string free = with(scene, "max_approach_speed_m_s = 5\n", "");
  const std::string narrow = refusal([&] { parse_node(with(free, "speed_m_s = 20", "speed_m_s = 1"), "axis.toml"); });
  EXPECT_NE(narrow.find("which must be 1 % above; raise that to 1.01"), std::string::npos) << narrow;
  parse_node(with(free, "speed_m_s = 20", "speed_m_s = 1.01"), "axis.toml");
  EXPECT_NE(refusal([&] { parse_node(with(scene, "\"brake\"", "\"pd\""), "axis.toml"); }).find("is for the coast"),
            std::string::npos);
}

}  // namespace
}  // namespace breakaway::config
