// The certificate of an axis whose load hangs on a spring: refused, under a rigid law, and under the coast "work".
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "certificate_scene.hpp"

namespace breakaway::config {
namespace {

// Motor and load of 0.4 and 0.6 kg, which the controller takes for one.
std::string with_load(const std::string& stiffness_N_per_m, const std::string& friction) {
  std::string text = with(scene, "mass_kg = 1", "mass_kg = 0.4");
  text = with(text, "lower_N = 2.5\nupper_N = 4.5", "lower_N = 1.3\nupper_N = 2.4");
  text = more("[told]", "mass_kg = 1\nfriction_lower_N = 2.5\nfriction_upper_N = 4.5", text);
  const auto move = text.find("[move]");
  text.erase(move, text.find("[drive]") - move);
  return more("[plant]", joined({"load = { mass_kg = 0.6, stiffness_N_per_m = ", stiffness_N_per_m, friction, " }"}),
              text);
}

std::string by_work(const std::string& text) {
  return with(with(text, "coast = \"brake\"", "coast = \"work\""), "tolerance_m = 5e-6", "tolerance_m = 2e-3");
}

TEST(Certificate, TakesALoadInThatResonatesFastEnough) {
  const std::string friction = ", friction_lower_N = 1.2, friction_upper_N = 2.1";
  EXPECT_EQ(why_not(with_load("2e8", friction)), "");
  expect_refused(with_load("1e6", friction), "the load resonates at 324.874 Hz");
  expect_refused(with_load("1e6", friction), "is safe from ");
  expect_refused(with_load("2e8", ""), "[plant] load: without friction of its own");
  expect_refused(with(with_load("2e8", friction), "mass_kg = 1\n", "mass_kg = 0.7\n"),
                 "[told] mass_kg = 0.7 is truly 1");
  expect_refused(with(with_load("2e8", friction), "friction_lower_N = 2.5", "friction_lower_N = 2.6"),
                 "friction may be between 2.5 and 4.5 N");
}

TEST(Certificate, OfTheCoastWorkTakesALoadAndItsBacklashIn) {
  const std::string friction = ", friction_lower_N = 1.2, friction_upper_N = 2.1";
  const std::string belt = by_work(with_load("3.4e4", friction));
  EXPECT_EQ(why_not(belt), "");
  EXPECT_EQ(why_not(more("[plant]", "backlash = { gap_m = 1e-5 }", belt)), "");
  expect_refused(with_load("3.4e4", friction), "take coast = \"work\"");
  EXPECT_EQ(why_not(by_work(with_load("3.4e4", friction + ", encoder = \"load\""))), "");
  expect_refused(by_work(with_load("3.4e4", "")), "[plant] load: without friction of its own");
  expect_refused(by_work(with_load("2e7", friction)), "swing_is_sampled");
  expect_refused(by_work(with_load("3.4e4", ", friction_lower_N = 0.1, friction_upper_N = 0.2")), "friction_is_shared");
  expect_refused(with(belt, "tolerance_m = 2e-3", "tolerance_m = 1e-4"), "tolerance_above_floor");
  expect_refused(more("[uncertainty]", "encoder_noise_m = 1e-6", belt), "work_keeps_time");
  expect_refused(with(belt, "mass = 0.02", "mass = 0.2"), "masses_and_gain_are_known");
  const std::string rigid = with(under_pd(), "coast = \"pd\"", "coast = \"work\"");
  expect_refused(rigid, "[controller] coast = \"work\" is for a load on a spring");
}

// Motor 1.3 to 2.4 N: the load must have a tenth of what both have at their least, and of what they have at their
// greatest.
TEST(Certificate, OfTheCoastWorkAsksBothSidesForTheirShareOfLeastAndOfGreatestFriction) {
  const auto shared = [](const std::string& bounds_N) { return why_not(by_work(with_load("3.4e4", bounds_N))); };
  const std::string enough = shared(", friction_lower_N = 0.16, friction_upper_N = 0.29");
  EXPECT_EQ(enough.find("friction_is_shared"), std::string::npos) << enough;
  EXPECT_NE(shared(", friction_lower_N = 0.13, friction_upper_N = 0.29").find("friction_is_shared"), std::string::npos);
  EXPECT_NE(shared(", friction_lower_N = 0.16, friction_upper_N = 0.25").find("friction_is_shared"), std::string::npos);
}

// What rests outside its tolerance is kicked, and what is further away than a kick reaches is approached again: a
// tolerance between the two would leave an axis with neither.
TEST(Certificate, OfTheCoastWorkRefusesAToleranceThatNoKickReaches) {
  const std::string belt = by_work(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1"));
  const double reach_m = examine(parse_node(belt, "axis.toml")).front().work->reach_m, count_m = 1e-6;
  const auto asked = [&](double tolerance_m) {
    const std::string roomy = with(belt, "following_error_m = 2", "following_error_m = 100");
    return why_not(with(roomy, "tolerance_m = 2e-3", joined({"tolerance_m = ", std::to_string(tolerance_m)})));
  };
  EXPECT_EQ(asked(0.99 * (reach_m - count_m)), "");
  EXPECT_NE(asked(1.01 * reach_m).find("kicks_reach_the_tolerance"), std::string::npos) << asked(1.01 * reach_m);
}

// What is told of the mass is what is certified, and not what the simulation knows: each side has its share of it.
TEST(Certificate, OfALoadIsForTheMassThatIsTold) {
  const std::string friction = ", friction_lower_N = 1.2, friction_upper_N = 2.1";
  const auto load_of = [](const std::string& text) {
    const Node node = parse_node(text, "axis.toml");
    return *braked_class(node, node.axes[0]).spring_load;
  };
  for (const std::string& text : {by_work(with_load("3.4e4", friction)), with_load("2e8", friction)}) {
    const std::string heavier = with(with(text, "mass_kg = 1\n", "mass_kg = 1.05\n"), "mass = 0.02", "mass = 0.06");
    EXPECT_DOUBLE_EQ(load_of(heavier).motor_kg, 1.05 * 0.4);
    EXPECT_DOUBLE_EQ(load_of(heavier).load_kg, 1.05 * 0.6);
    EXPECT_DOUBLE_EQ(load_of(text).motor_kg, 0.4);
  }
}

// Each side has bounds of its own, which friction that drifts leaves though both together stay within what is told.
TEST(Certificate, OfALoadTakesInThatTheFrictionOfEitherSideDrifts) {
  const std::string belt = by_work(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1"));
  const std::string wide = with(with(belt, "friction_lower_N = 2.5\n", "friction_lower_N = 1.7\n"),
                                "friction_upper_N = 4.5\n", "friction_upper_N = 6\n");
  EXPECT_EQ(why_not(wide), "");
  expect_refused(more("[plant]", "drift = { share = 0.3, period_s = 3 }", wide), "friction_is_known");
  const std::string drifting = more("[plant]", "drift = { share = 0.1, period_s = 3 }", wide);
  const Node node = parse_node(drifting, "axis.toml");
  const design::SpringLoad load = *braked_class(node, node.axes[0]).spring_load;
  EXPECT_DOUBLE_EQ(load.motor_friction.lower_N, 0.9 * 1.3);
  EXPECT_DOUBLE_EQ(load.motor_friction.upper_N, 1.1 * 2.4);
  EXPECT_DOUBLE_EQ(load.load_friction.lower_N, 0.9 * 1.2);
  EXPECT_DOUBLE_EQ(load.load_friction.upper_N, 1.1 * 2.1);
}

// A tonne may be kicked for longer than a minute and come no nearer than where its approach passed the target.
TEST(Certificate, OfTheCoastWorkGivesASlowAxisTheTimeThatItsKicksNeed) {
  using std::chrono::seconds;
  const std::string belt = by_work(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1"));
  const auto timeout_of = [](const std::string& text) {
    return flashed_by_work<float>(parse_node(text, "axis.toml")).axes[0].limits.progress_timeout;
  };
  EXPECT_EQ(timeout_of(belt), seconds{60});
  std::string slow = with(with(belt, "mass_kg = 0.4", "mass_kg = 400"), "mass_kg = 0.6", "mass_kg = 600");
  slow = with(with(slow, "mass_kg = 1\n", "mass_kg = 1000\n"), "period_s = 0.001", "period_s = 0.01");
  slow = with(slow, "k1_N_per_m = 400", "k1_N_per_m = 0.4");
  EXPECT_GT(timeout_of(slow), seconds{150});
}

// An approach passes its target, and goes faster than it is planned.
TEST(Certificate, OfTheCoastWorkAsksLimitsForRoomForApproaches) {
  const std::string belt = by_work(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1"));
  const design::WorkPromise promise = *examine(parse_node(belt, "axis.toml")).front().work;
  EXPECT_GT(promise.approach_beyond_m, 0);
  EXPECT_GT(promise.approach_peak_m_s, 5);
  const auto said_of = [](const std::string& text) { return refusal([&] { static_cast<void>(why_not(text)); }); };
  const auto with_target = [&](double share) {
    return with(belt, "target_m = 0\n",
                joined({"target_m = ", std::to_string(1 - share * promise.approach_beyond_m), "\n"}));
  };
  EXPECT_EQ(said_of(with_target(1.01)), "");
  EXPECT_NE(said_of(with_target(0.99)).find("outside the [limits] of position"), std::string::npos);
  const auto followed = [&](double share) {
    return with(belt, "following_error_m = 2\n",
                joined({"following_error_m = ", std::to_string(share * promise.approach_beyond_m), "\n"}));
  };
  EXPECT_EQ(said_of(followed(1.01)), "");
  EXPECT_NE(said_of(followed(0.99)).find("following_error_m"), std::string::npos);
}

// Its approach counts its periods, and a float holds its plan, over so much only.
TEST(Certificate, OfTheCoastWorkRefusesTargetsThatAreTooFarAway) {
  const std::string belt = with(by_work(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1")),
                                "encoder_resolution_m = 1e-6", "encoder_resolution_m = 2e-6");
  const double most_m = examine(parse_node(belt, "axis.toml")).front().work->farthest_m;
  const auto said_of = [](const std::string& text) { return refusal([&] { static_cast<void>(why_not(text)); }); };
  const auto between_limits = [&](double room_m) {
    return with(belt, "position_m = 1\n", joined({"position_m = ", std::to_string(room_m / 2), "\n"}));
  };
  EXPECT_EQ(why_not(between_limits(0.99 * most_m)), "");
  EXPECT_NE(said_of(between_limits(1.01 * most_m)).find("[limits] of position let a target be"), std::string::npos);
  const std::string unlimited = with(belt, "position_m = 1\n", "");
  const auto unlimited_to = [&](double target_m) {
    const std::string change = "targets = [ { time_s = 0.5, position_m = " + std::to_string(target_m) + " } ]\n";
    return with(unlimited, "target_m = 0\n", "target_m = 0\n" + change);
  };
  EXPECT_EQ(why_not(unlimited_to(-0.99 * most_m)), "");
  EXPECT_NE(said_of(unlimited_to(-1.01 * most_m)).find("[controller] has a target that is"), std::string::npos);
}

// A node is certified, flashed and run from what its own reader says, which no simulation has looked at.
TEST(ReadNode, TakesALoadToTheLetter) {
  const std::string friction = ", friction_lower_N = 1.2, friction_upper_N = 2.1";
  const auto said_of = [](const std::string& text) {
    return breakaway::testing::refusal([&] { static_cast<void>(parse_node(text, "axis.toml")); });
  };
  EXPECT_EQ(said_of(with_load("3.4e4", friction + ", encoder = \"load\"")), "");
  const auto expect_said = [&](const std::string& text, const std::string& words) {
    EXPECT_NE(said_of(text).find(words), std::string::npos) << words << ": " << said_of(text);
  };
  expect_said(with_load("3.4e4", friction + ", encoder = \"laod\""), "\"motor\" or \"load\"");
  expect_said(with_load("-3.4e4", friction), "stiffness_N_per_m");
  expect_said(with_load("0", friction), "stiffness_N_per_m");
  expect_said(with_load("3.4e4", friction + ", dampign_Ns_per_m = 2"), "damping_Ns_per_m");
  expect_said(with_load("3.4e4", ", friction_lower_N = 1.2"), "give both bounds of the load's friction");
  expect_said(with_load("3.4e4", ", friction_upper_N = 2.1"), "give both bounds of the load's friction");
  expect_said(with_load("3.4e4", ", friction_lower_N = 2.1, friction_upper_N = 1.2"), "swap or correct them");
  expect_said(more("[plant]", "backlash = { gap_m = -1e-5 }", with_load("3.4e4", friction)), "gap_m");
}

TEST(Certificate, OfTheCoastWorkIsWrittenAsItIsFlashed) {
  const Node node =
      parse_node(by_work(with_load("3.4e4", ", friction_lower_N = 1.2, friction_upper_N = 2.1")), "axis.toml");
  ASSERT_TRUE(is_by_work(node));
  const auto reports = examine(node);
  const WorkNode<float> flashed = certified_by_work(node, reports);
  const auto design = design::design_work_kicks<float>(braked_class(node, node.axes[0]));
  EXPECT_EQ(flashed.axes[0].kicks.table.entries[3].a0, design.kicks.table.entries[3].a0);
  EXPECT_TRUE(flashed.axes[0].kicks.metered);
  const std::string header = node_header(flashed, node, reports);
  EXPECT_NE(header.find("FlashedNode<float, 1, law::WorkKicks<float>> node"), std::string::npos);
  EXPECT_NE(header.find("law::Coast::work"), std::string::npos);
  WorkNode<float> spoiled = flashed;
  spoiled.axes[0].kicks.spring_m += 1e-6F;
  EXPECT_EQ(firmware::verify(spoiled).error, firmware::NodeError::checksum_differs);
  spoiled.axes[0].kicks.table.count = 0;
  spoiled.checksum = checksum_of(spoiled);
  EXPECT_EQ(firmware::verify(spoiled).error, firmware::NodeError::law_invalid);
  spoiled = flashed;
  spoiled.axes[0].law.coast = law::Coast::brake;
  spoiled.checksum = checksum_of(spoiled);
  EXPECT_EQ(firmware::verify(spoiled).error, firmware::NodeError::law_invalid) << "its kicks are of another coast";
}

}  // namespace
}  // namespace breakaway::config
