// A [machine] behind the drives of axes: what the file says of it, and what it must not say.
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/scenario/open_loop.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::scenario {
namespace {

const std::string sound = R"(
[machine]
mass = [[2, 0.5], [0.5, 3]]
damping = [[0, 0], [0, 0]]
stiffness = [[100, -100], [-100, 100]]
directions = [[1, 0], [0, 1]]
friction_N = [3, 1]
[start]
q = [-0.1, -0.2]
[loop]
period_s = 0.001
[plant]
mass_kg = 4
machine = { push = 1 }
[friction]
lower_N = 2.5
upper_N = 4.5
[controller]
k1_N_per_m = 400
k21_Ns_per_m = 32
k22_Ns_per_m = 120
coast = "pd"
max_force_N = 5
[drive]
rated_torque_Nm = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = 10
encoder_resolution_m = 1e-6
[run]
settle_tolerance_m = 1e-5
duration_s = 1
)";

std::string with(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CoupledMachine, StandsBehindAnAxisThatSaysWhatItPushesAndReads) {
  const auto any = parse_any_scenario(sound, "axis.toml");
  ASSERT_TRUE(std::holds_alternative<Scenario>(any));
  const auto& s = std::get<Scenario>(any);
  ASSERT_TRUE(s.machine);
  EXPECT_EQ(s.machine->machine.mass(0, 1), 0.5);
  EXPECT_EQ(s.machine->start.q, Eigen::Vector2d(-0.1, -0.2));
  EXPECT_EQ(s.machine->start.v, Eigen::Vector2d(0, 0));
  EXPECT_EQ(s.worlds[0].place->push, Eigen::Vector2d(1, 0));
  EXPECT_EQ(s.worlds[0].place->read, Eigen::Vector2d(1, 0)) << "what it pushes";
  EXPECT_EQ(s.node.axes[0].mass_kg, 4) << "what its controller is told";
}

// Its [plant] says nothing of where it starts.
TEST(CoupledMachine, StartsWhereItsHomeAndItsLimitsLetItStart) {
  const auto said_of = [](const std::string& of_drive, const std::string& of_axis) {
    const std::string text = with(sound, "encoder_resolution_m = 1e-6", "encoder_resolution_m = 1e-6\n" + of_drive);
    return testing::refusal([&] { parse_scenario(with(text, "[run]", of_axis + "[run]"), "axis.toml"); });
  };
  EXPECT_EQ(said_of("home = \"here\"\nhome_position_m = -0.1\n", ""), "");
  EXPECT_EQ(said_of("home = \"here\"\n", ""),
            "axis.toml: what it reads of [start] q = -0.1 is not where [drive] home says that the axis stands when it "
            "begins, home_position_m = 0; give both the same");
  EXPECT_NE(said_of("", "[limits]\nposition_m = 0.05\n").find("is outside the [limits], -0.05 to 0.05 m"),
            std::string::npos);
}

TEST(CoupledMachine, TakesAPlaceThatIsSharedByCoordinates) {
  const auto s = parse_scenario(with(sound, "push = 1", "push = [1, 0.6], read = 2"), "axis.toml");
  EXPECT_EQ(s.worlds[0].place->push, Eigen::Vector2d(1, 0.6));
  EXPECT_EQ(s.worlds[0].place->read, Eigen::Vector2d(0, 1));
}

TEST(CoupledMachine, StartsAtZeroUnlessToldOtherwise) {
  const auto s = parse_scenario(with(sound, "[start]\nq = [-0.1, -0.2]\n", ""), "axis.toml");
  EXPECT_EQ(s.machine->start.q, Eigen::Vector2d(0, 0));
}

TEST(CoupledMachine, IsPassedOverByTheNode) {
  const config::Node node = config::parse_node(sound, "axis.toml");
  EXPECT_EQ(node.axes[0].mass_kg, 4);
}

TEST(CoupledMachine, IsSaidInOneSentenceWhatIsWrong) {
  struct Case {
    std::string from, to, names;
  };
  const std::vector<Case> cases{
      {"machine = { push = 1 }", "", "[plant.machine] is missing: say which coordinate"},
      {"push = 1", "push = 3", "push is 3, and the [machine] has 2 coordinates"},
      {"push = 1", "push = 0", "push is 0, must be the number of a coordinate, from 1, or an array"},
      {"push = 1", "push = [1]", "push has 1 shares, and the [machine] has 2 coordinates"},
      {"push = 1", "push = [0, 0]", "push is zero in every coordinate"},
      {"push = 1", "push = [1e-300, 0]", "push is zero in every coordinate, or below 1e-06"},
      {"push = 1", "push = [1e300, 0]", "push is [1e+300, 0], must be the number of a coordinate, from 1, or an array"},
      {"push = 1", "push = [inf, 0]", "push is [inf, 0], must be"},
      {"push = 1", "push = [1, \"a\"]", "push is [1, 'a'], must be"},
      {"push = 1", "push = 1, read = 5", "read is 5"},
      {"push = 1", "read = 1", "push is missing"},
      {"push = 1", "push = 1, pull = 2", "pull is not a key here"},
      {"mass_kg = 4", "mass_kg = 4\nposition_m = 1", "where it starts into [start]"},
      {"mass_kg = 4", "mass_kg = 4\nforce_N = 1", "moves as the [machine] does"},
      {"mass_kg = 4", "mass_kg = 4\ncogging = { amplitude_N = 1, period_m = 1 }", "moves as the [machine] does"},
      {"upper_N = 4.5", "upper_N = 4.5\nlaw = { kind = \"constant\" }", "moves as the [machine] does"},
      {"[run]", "[told]\nmass_kg = 3\n[run]", "write what the controller is told into [plant] mass_kg"},
      {"q = [-0.1, -0.2]", "q = [1e200, -0.2]",
       "[start] q is [1e+200, -0.2], must be an array, each entry a number in"},
      {"[run]", "[run]\nintegrator = \"adaptive\"", "it is for a [machine] without axes; leave it out, or ask an axis"},
      {"q = [-0.1, -0.2]", "q = [-0.1]", "[start] q is 1 x 1, must be 2 x 1"},
      {"friction_N = [3, 1]", "friction_N = [3]", "[machine] friction_N"},
      {"friction_N = [3, 1]\n",
       "[[machine.friction]]\nlower_N = 1\nupper_N = 3\nlaw = { kind = \"stribeck\", velocity_m_s = 1 }\n"
       "[[machine.friction]]\nlower_N = 1\nupper_N = 3\n",
       "has a law; behind drives the friction of a machine is constant"},
      {"[run]", "[feedback]\nposition_gain = [[1, 0]]\n[run]",
       "feedback is not a key here: it is for a [machine] without axes"},
  };
  for (const Case& bad : cases) {
    const std::string text = with(sound, bad.from, bad.to);
    const std::string said = testing::refusal([&] { parse_any_scenario(text, "axis.toml"); });
    EXPECT_NE(said.find(bad.names), std::string::npos) << bad.to << ": " << said;
    EXPECT_EQ(said.find("axis.toml:"), 0U) << said;
  }
}

TEST(CoupledMachine, IsMissedWhereAnAxisSaysThatItHasOne) {
  const auto from = sound.find("[machine]"), to = sound.find("[loop]");
  const std::string without = std::string{sound}.erase(from, to - from);
  EXPECT_NE(
      testing::refusal([&] { parse_any_scenario(without, "axis.toml"); }).find("[plant.machine] needs a [machine]"),
      std::string::npos);
  const std::string start = with(with(without, "machine = { push = 1 }\n", ""), "[loop]", "[start]\nq = [0]\n[loop]");
  EXPECT_NE(testing::refusal([&] { parse_any_scenario(start, "axis.toml"); }).find("[start] q needs a [machine]"),
            std::string::npos);
}

TEST(CoupledMachine, IsNotLookedAtAsIfItHadNoDrives) {
  EXPECT_NE(
      testing::refusal([&] { parse_machine_scenario(sound, "axis.toml"); }).find("has axes with drives beside it"),
      std::string::npos);
}

TEST(CoupledMachine, KeepsItsAxesTogether) {
  const auto s = read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/gantry.toml");
  EXPECT_NE(testing::refusal([&] { only_axis(s, "left"); }).find("has a [machine] that its axes share"),
            std::string::npos);
}

}  // namespace
}  // namespace breakaway::scenario
