// A [drive] of protocol "odrive": what it is read as, and what is refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/odrive/drive.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::scenario::odrive_file {
namespace {

using breakaway::config::Protocol;
using breakaway::scenario::parse_scenario;
using breakaway::scenario::Scenario;
using breakaway::testing::refusal;

const std::string sound = R"(
[plant]
mass_kg = 1
[friction]
lower_N = 2.5
upper_N = 4.5
[controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 60
max_force_N = 30
position_tolerance_m = 2e-6
[loop]
period_s = 0.001
[drive]
protocol = "odrive"
travel_per_turn_m = 0.125
max_torque_Nm = 1
force_per_torque_N_per_Nm = 50
encoder_resolution_m = 1e-6
[limits]
position_m = 7.9
[run]
duration_s = 1
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
std::string with_key(const std::string& line) { return with(sound, "[limits]", line + "\n[limits]"); }
std::string certifiable() {
  std::string text = with(sound, "[limits]", "estimates = \"polled\"\n[uncertainty]\njitter_s = 3.4e-4\n[limits]");
  text = with(text, "max_force_N = 30", "coast = \"brake\"\nmax_force_N = 30");
  return with(text, "position_tolerance_m = 2e-6", "position_tolerance_m = 6e-6");
}
std::string refused(const std::string& text) {
  return refusal([&] { parse_scenario(text, "axis.toml"); });
}

TEST(OdriveInAFile, IsReadWithWhatItIsToldAndWhatEmulatesIt) {
  const Scenario s = parse_scenario(
      with_key("torque_constant_Nm_per_A = 0.05\nvelocity_limit_turns_s = 40\nnode_id = 0"), "axis.toml");
  const auto& axis = s.node.axes.front();
  ASSERT_TRUE(axis.drive->odrive);
  EXPECT_EQ(axis.drive->protocol(), Protocol::odrive);
  EXPECT_FALSE(s.worlds.front().drive);
  ASSERT_TRUE(s.worlds.front().odrive);
  EXPECT_EQ(s.worlds.front().odrive->travel_per_turn_m, 0.125);
  const auto told = breakaway::config::odrive_config<float>(axis);
  EXPECT_EQ(told.node_id, 0);
  EXPECT_DOUBLE_EQ(told.counts_per_turn, 125000);
  EXPECT_FLOAT_EQ(told.current_limit_A, 30.0F / 50 / 0.05F) << "of the axis' limit, not of the motor's";
  EXPECT_EQ(told.velocity_limit_turns_s, 40);
  EXPECT_EQ(check(told, {.period = std::chrono::milliseconds{1}}, breakaway::hal::AxisScale<float>{1e-6F, 30}),
            breakaway::odrive::DriveConfigError::none);
  EXPECT_DOUBLE_EQ(axis.drive->max_force_N(), 50);
  EXPECT_DOUBLE_EQ(axis.drive->force_quantum_N(), 50.0 / 16384);
}

TEST(OdriveInAFile, IsEmulatedWithAWatchdogThatASlowLoopFeedsInTime) {
  const auto watchdog_of = [](const std::string& text) {
    return parse_scenario(text, "axis.toml").worlds.front().odrive->watchdog_timeout;
  };
  using std::chrono_literals::operator""ms;
  EXPECT_EQ(watchdog_of(sound), 50ms);
  EXPECT_EQ(watchdog_of(with(sound, "period_s = 0.001", "period_s = 0.04")), 120ms);
}

TEST(OdriveInAFile, IsCanopenUnlessItSaysOtherwise) {
  const std::string canopen =
      with(with(with(sound, "protocol = \"odrive\"\n", ""), "travel_per_turn_m = 0.125\n", "rated_torque_Nm = 1\n"),
           "max_torque_Nm = 1\n", "max_torque_per_mille = 1000\n");
  EXPECT_EQ(parse_scenario(canopen, "axis.toml").node.axes.front().drive->protocol(), Protocol::canopen);
  EXPECT_EQ(refused(with(canopen, "rated_torque_Nm", "protocol = \"canopen\"\nrated_torque_Nm")), "");
}

// 7.9 m are 63.2 turns, where neighbouring floats are 2^-18 turns apart.
TEST(OdriveInAFile, CountsHalfTheSpacingOfItsFloatIntoEveryReading) {
  const auto axis = parse_scenario(sound, "axis.toml").node.axes.front();
  EXPECT_DOUBLE_EQ(axis.uncertainty.encoder_noise_m, 0x1p-18 * 0.125 / 2);
  EXPECT_DOUBLE_EQ(breakaway::config::reading_error_m(axis), 0.5e-6 + 0x1p-18 * 0.125 / 2);
  const auto noisy = parse_scenario(with(sound, "[run]", "[uncertainty]\nencoder_noise_m = 1e-6\n[run]"), "axis.toml");
  EXPECT_DOUBLE_EQ(noisy.node.axes.front().uncertainty.encoder_noise_m, 1e-6 + 0x1p-18 * 0.125 / 2);
}

struct Refused {
  const char* label;
  std::string text;
  std::vector<std::string> named;
};

TEST(OdriveInAFile, IsRefusedByNameWhereItCannotBe) {
  const std::string two = R"(
[loop]
period_s = 0.001
[[axis]]
name = "x"
plant = { mass_kg = 1 }
friction = { lower_N = 2.5, upper_N = 4.5 }
controller = { k1_N_per_m = 400, k21_Ns_per_m = 32, k22_Ns_per_m = 60 }
limits = { position_m = 1 }
drive = { protocol = "odrive", travel_per_turn_m = 0.1, max_torque_Nm = 1, force_per_torque_N_per_Nm = 50, encoder_resolution_m = 1e-6 }
[[axis]]
name = "y"
plant = { mass_kg = 1 }
friction = { lower_N = 2.5, upper_N = 4.5 }
controller = { k1_N_per_m = 400, k21_Ns_per_m = 32, k22_Ns_per_m = 60 }
limits = { position_m = 1 }
drive = { rated_torque_Nm = 1, max_torque_per_mille = 1000, force_per_torque_N_per_Nm = 50, encoder_resolution_m = 1e-6 }
)";
  const std::vector<Refused> table{
      {"another protocol", with(sound, "\"odrive\"", "\"moteus\""), {"protocol", "canopen", "odrive"}},
      {"no travel of a turn", with(sound, "travel_per_turn_m = 0.125\n", ""), {"travel_per_turn_m"}},
      {"node id of none", with_key("node_id = 63"), {"node_id", "62"}},
      {"a rated torque", with_key("rated_torque_Nm = 1"), {"rated_torque_Nm", "canopen"}},
      {"an SDO timeout", with_key("sdo_timeout_s = 0.1"), {"sdo_timeout_s", "canopen"}},
      {"EMCY", with_key("emcy_information = [\"FF01h\"]"), {"[drive] emcy_information is not a key here", "canopen"}},
      {"quirks of CANopen", with_key("quirks = { self_starting = true }"), {"quirks", "canopen"}},
      {"a home that it finds", with_key("home = \"drive\""), {"home", "here"}},
      {"no limits of position", with(sound, "position_m = 7.9", "speed_m_s = 5"), {"protocol", "[limits] position_m"}},
      {"a range that is too wide", with(sound, "7.9", "16.1"), {"position_m", "16.1", "128.8 turns", "coarser"}},
      {"too far on one side",
       with(sound, "position_m = 7.9", "position_min_m = -1\nposition_max_m = 20"),
       {"position_max_m", "20 m"}},
      {"half a limit", with_key("velocity_limit_turns_s = 5"), {"torque_constant_Nm_per_A", "missing"}},
      {"the other half", with_key("torque_constant_Nm_per_A = 5"), {"velocity_limit_turns_s", "missing"}},
      {"a timeout that a lost sample is longer than",
       with_key("heartbeat_period_s = 0.001\nheartbeat_timeout_s = 0.003"),
       {"heartbeat_timeout_s is 0.003", "three periods of the loop, 0.003", "raise"}},
      {"estimates that are too rare", with_key("estimate_period_s = 0.002"), {"estimate_period_s", "polled"}},
      {"estimates in part of a millisecond",
       with(with_key("estimate_period_s = 0.0015"), "period_s = 0.001", "period_s = 0.002"),
       {"estimate_period_s", "whole milliseconds"}},
      {"a period of what is polled",
       with_key("estimates = \"polled\"\nestimate_period_s = 0.001"),
       {"estimate_period_s", "cyclic"}},
      {"a loop that is faster than the estimates",
       with(sound, "period_s = 0.001", "period_s = 0.0008"),
       {"estimate_period_s", "polled"}},
      {"two protocols on a bus", two, {"protocol", "axis x"}},
      {"a machine",
       with(sound, "[plant]\nmass_kg = 1", R"([machine]
mass = [[1]]
damping = [[0]]
stiffness = [[0]]
directions = [[1]]
friction_N = [3]
[plant]
mass_kg = 1
machine = { push = 1 })"),
       {"protocol", "[machine]"}},
      {"a node id of the master", with(sound, "0.001", "0.001\nnode_id = 5"), {"node_id", "[loop]", "odrive"}},
      {"a heartbeat of the master", with(sound, "0.001", "0.001\nheartbeat_period_s = 0.1"), {"heartbeat_period_s"}},
      {"a commander", with(sound, "0.001", "0.001\ncommand_timeout_s = 1"), {"command_timeout_s", "odrive"}},
      {"a coupling", with(sound, "[run]", "[coupling]\nmass = [[1]]\nstart_m = 0.03\n[run]"), {"[coupling]", "odrive"}},
  };
  for (const Refused& row : table) {
    const std::string said = refused(row.text);
    EXPECT_FALSE(said.empty()) << row.label;
    for (const std::string& name : row.named)
      EXPECT_NE(said.find(name), std::string::npos) << row.label << " lacks " << name << ": " << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

// As it is typed.
TEST(OdriveInAFile, TakesTheResolutionThatItsRefusalNames) {
  for (const char* farthest : {"16.1", "33", "100"}) {
    const std::string wide = with(sound, "7.9", farthest), said = refused(wide);
    const std::string named = said.substr(said.find("in steps of ") + 12);
    const std::string steps = named.substr(0, named.find(' '));
    EXPECT_EQ(refused(with(wide, "encoder_resolution_m = 1e-6", "encoder_resolution_m = " + steps)).find("coarser"),
              std::string::npos)
        << said;
  }
}

// None would do, and it is said that the drive is what forbids it.
TEST(OdriveInAFile, IsNotCertifiedWhereFrictionBends) {
  const std::string bends = with(certifiable(), "lower_N = 2.5", "presliding_stiffness_N_per_m = 1e7\nlower_N = 2.5");
  const auto s = parse_scenario(bends, "axis.toml");
  const auto report = breakaway::config::examine(s.node).front();
  ASSERT_FALSE(report.certified);
  std::string all;
  for (const std::string& reason : report.reasons) all += reason + '\n';
  EXPECT_NE(all.find("has no SYNC; take protocol = \"canopen\""), std::string::npos) << all;
  EXPECT_NE(all.find("state neither, of a drive that shows no float as its position"), std::string::npos) << all;
}

TEST(OdriveInAFile, IsForNoBoard) {
  const auto node = parse_scenario(certifiable(), "axis.toml").node;
  breakaway::config::require_runnable(node);
  EXPECT_NE(refusal([&] { breakaway::config::require_flashable(node); }).find("boards"), std::string::npos);
  const auto reports = breakaway::config::examine(node);
  const auto flashed = breakaway::config::certified(node, reports);
  EXPECT_NE(refusal([&] { breakaway::config::node_header(flashed, node, reports); }).find("boards"), std::string::npos);
}

// What keeps it from being certified; empty where nothing does.
std::string why_not(const std::string& text) {
  const auto node = parse_scenario(text, "axis.toml").node;
  return breakaway::config::why_not_certified(node, node.axes.front());
}

TEST(OdriveInAFile, IsCertifiedWhereItIsAskedAndTheFileStatesItsTiming) {
  EXPECT_EQ(why_not(certifiable()), "");
  const struct {
    std::string what, from, to;
    std::vector<std::string> named;
  } cases[] = {
      {"too little jitter", "jitter_s = 3.4e-4", "jitter_s = 3.3e-4", {"jitter_s = 0.00033 is less", "0.000339 s off"}},
      {"cyclic", "estimates = \"polled\"", "", {"estimates = \"cyclic\"", "take estimates = \"polled\"", "0.000339"}},
      {"the coast pd", "coast = \"brake\"", "coast = \"pd\"", {"take coast = \"brake\" with [uncertainty] jitter_s"}},
      {"a slow bus",
       "[limits]",
       "[bus]\nbit_rate = 560000\n[limits]",
       {"takes in half a period", "period_s of at least"}},
      {"a bus that delays", "[limits]", "[bus]\ndelay_min_s = 1e-5\ndelay_max_s = 6e-5\n[limits]", {"0.000389 s off"}},
  };
  for (const auto& c : cases) {
    const std::string said = why_not(with(certifiable(), c.from, c.to));
    EXPECT_EQ(said.empty(), c.named.empty()) << c.what << ": " << said;
    for (const std::string& named : c.named) EXPECT_NE(said.find(named), std::string::npos) << c.what << ": " << said;
  }
}

// What a sentence asks for must be enough.
TEST(OdriveInAFile, IsCertifiedWithTheJitterThatItIsAskedFor) {
  EXPECT_EQ(why_not(with(certifiable(), "3.4e-4", "0.000339")), "");
}

TEST(OdriveInAFile, OfSeveralAxesCertifiesEachWithTheFramesOfAll) {
  const std::string text = R"(
[[axis]]
name = "x"
plant = { mass_kg = 1 }
friction = { lower_N = 2.5, upper_N = 4.5 }
controller = { k1_N_per_m = 400, k21_Ns_per_m = 32, k22_Ns_per_m = 60, max_force_N = 30, position_tolerance_m = 5e-5 }
drive = { protocol = "odrive", travel_per_turn_m = 0.125, max_torque_Nm = 1, force_per_torque_N_per_Nm = 50, encoder_resolution_m = 1e-6, estimates = "polled" }
limits = { position_m = 7.9 }
uncertainty = { jitter_s = 0.000989 }
)";
  const std::string second = with(text, "\"x\"", "\"y\"");
  const std::string rest = "[loop]\nperiod_s = 0.002\n[run]\nduration_s = 1\n";
  EXPECT_EQ(why_not(rest + text + second), "");
  EXPECT_NE(why_not(rest + with(text, "0.000989", "0.000988") + second).find("0.000989 s off"), std::string::npos);
  const std::string frequent =
      with(text, "polled\"", "polled\", heartbeat_period_s = 0.001, heartbeat_timeout_s = 0.1");
  EXPECT_NE(why_not(rest + frequent + second).find("half a period"), std::string::npos);
  EXPECT_NE(why_not(rest + text + second + with(text, "\"x\"", "\"z\"")).find("half a period"), std::string::npos);
}

TEST(OdriveInAFile, MustFitItsBus) {
  const auto fits = [](const std::string& text) {
    return refusal([&] { breakaway::config::require_fitting_bus(parse_scenario(text, "axis.toml").node); });
  };
  EXPECT_EQ(fits(sound), "");
  const std::string slow = with(sound, "[limits]", "[bus]\nbit_rate = 500000\n[limits]");
  EXPECT_NE(fits(slow).find("1080 us"), std::string::npos) << fits(slow);
  const std::string polled = with(with_key("estimates = \"polled\""), "period_s = 0.001", "period_s = 0.000650");
  EXPECT_EQ(fits(polled), "");
  EXPECT_NE(fits(with(polled, "0.000650", "0.000640")).find("choose a period_s of at least 0.00065"),
            std::string::npos);
}

}  // namespace
}  // namespace breakaway::scenario::odrive_file
