#include "breakaway/scenario/machine_scenario.hpp"

#include <gtest/gtest.h>

#include <string>

#include "breakaway/input/input_error.hpp"

namespace {

using namespace breakaway::scenario;
using breakaway::InputError;

const std::string machine = R"(
[machine]
mass = [[1, 0], [0, 2]]
damping = [[0.1, 0], [0, 0.2]]
stiffness = [[2, -1], [-1, 2]]
directions = [[1], [-1]]
friction_N = [0.5]
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

void expect_refused(const std::string& text, const std::string& message) {
  try {
    parse_machine_scenario(text, "m.toml");
    ADD_FAILURE() << "accepted: " << text;
  } catch (const InputError& error) {
    EXPECT_NE(std::string{error.what()}.find(message), std::string::npos) << error.what();
  }
}

TEST(MachineScenario, ReadsTheExample) {
  const auto any = read_any_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_mass_example.toml");
  const auto& s = std::get<MachineScenario>(any);
  EXPECT_EQ(s.machine.damping, (Eigen::Matrix2d{{0.125, 0.375}, {0.375, 0.125}}));
  EXPECT_EQ(s.start->q, (Eigen::Vector2d{2.5, -1}));
  EXPECT_EQ(s.start->v, Eigen::Vector2d::Zero());
  EXPECT_EQ(s.integrator, Integrator::event_driven);
}

TEST(MachineScenario, TellsAxesFromMachines) {
  const auto any = read_any_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/impulsive_example.toml");
  EXPECT_TRUE(std::holds_alternative<Scenario>(any));
}

TEST(MachineScenario, ReadsTheShapesOfItsMatrices) {
  const auto s = parse_machine_scenario(machine, "m.toml");
  EXPECT_EQ(s.machine.coordinates(), 2);
  EXPECT_EQ(s.machine.frictions(), 1);
  EXPECT_EQ(s.machine.stiffness(0, 1), -1);
  EXPECT_FALSE(s.start);
  const auto frictionless = replaced(replaced(machine, "[[1], [-1]]", "[[], []]"), "[0.5]", "[]");
  EXPECT_EQ(parse_machine_scenario(frictionless, "m.toml").machine.frictions(), 0);
}

// (29): K + S F1 and C + S F2 with one actuator between the two coordinates.
TEST(MachineScenario, ClosesTheLoop) {
  const auto s = parse_machine_scenario(
      machine + "[feedback]\nactuators = [[1], [-1]]\nposition_gain = [[3, -3]]\nvelocity_gain = [[4, -4]]\n",
      "m.toml");
  EXPECT_EQ(s.machine.stiffness, (Eigen::Matrix2d{{5, -4}, {-4, 5}}));
  const Eigen::Matrix2d damping{{4.1, -4}, {-4, 4.2}};
  EXPECT_TRUE(s.machine.damping.isApprox(damping, 1e-15)) << "less what rounding may have added to 0.1 + 4";
}

TEST(MachineScenario, RefusesBadInputByName) {
  expect_refused("", "machine is missing");
  expect_refused(replaced(machine, "mass", "mas"), "m.toml:3: [machine] mas is not a key");
  expect_refused(replaced(machine, "[[1, 0], [0, 2]]", "[[1, 0], [0]]"), "mass is [[1, 0], [0]], must be rows");
  expect_refused(replaced(machine, "[[1, 0], [0, 2]]", "[[1, 0], [0, nan]]"), "mass");
  expect_refused(replaced(machine, "[[1, 0], [0, 2]]", "[[1, 0], [0, -2]]"), "mass is not positive definite");
  expect_refused(replaced(machine, "[[1, 0], [0, 2]]", "[[1, 1], [0, 2]]"), "mass is not symmetric");
  expect_refused(replaced(machine, "[[1, 0], [0, 2]]", "3"), "mass is 3");
  expect_refused(replaced(machine, "[[0.1, 0], [0, 0.2]]", "[[0.1]]"), "m.toml:4: [machine] damping is 1 x 1");
  expect_refused(replaced(machine, "[0.5]", "[-0.5]"), "friction_N");
  expect_refused(replaced(machine, "[0.5]", "[1, 2]"), "friction_N is 2 x 1");
  expect_refused(replaced(machine, "[0.5]", "[1.1e12]"), "friction_N");
  expect_refused(replaced(machine, "[[1], [-1]]", "[[1], [-1.1e12]]"), "directions");
  expect_refused(machine + "[start]\nq = [1]\n", "m.toml:9: [start] q is 1 x 1, must be 2 x 1");
  expect_refused(machine + "[start]\nv = [1, 2]\n", "q is missing");
  expect_refused(machine + "[feedback]\nposition_gain = [[1, 2, 3]]\n", "position_gain is 1 x 3, must be 2 x 2");
  expect_refused(machine + "[run]\nsettle_tolerance_m = 1e-3\n", "it is for axes with a [controller]");
  expect_refused(machine + "[told]\nmass_kg = 1\n", "told is not a key here: it is for an axis");
  expect_refused("[plant]\nmass_kg = 1\n", "m.toml: describes an axis, and a [machine] is asked for");
  expect_refused(machine + "[run]\nintegrator = \"euler\"\n", "event_driven");
  expect_refused(machine + "[run]\nstep_s = 1e-3\n", "time_stepping");
  expect_refused(machine + "[run]\nintegrator = \"time_stepping\"\nstep_s = 1e-9\nduration_s = 1e9\n", "step_s");
}

const std::string with_laws = replaced(machine, "friction_N = [0.5]", R"([[machine.friction]]
lower_N = 0.25
upper_N = 0.5
law = { kind = "stribeck", velocity_m_s = 0.1 })");

TEST(MachineScenario, ReadsTheLawsOfItsFrictions) {
  const auto s = parse_machine_scenario(with_laws, "m.toml");
  ASSERT_EQ(s.laws.size(), 1U);
  EXPECT_EQ(s.laws[0].level_N(0, 0, 0.1), 0.375);
  EXPECT_EQ(s.machine.friction_N[0], 0.25);
  EXPECT_EQ(s.integrator, Integrator::adaptive);
  EXPECT_EQ(parse_machine_scenario(with_laws + "[run]\ntolerance = 1e-9\n", "m.toml").tolerance, 1e-9);
}

TEST(MachineScenario, FrictionWithoutALawIsConstantAtItsUpperBound) {
  const auto s = parse_machine_scenario(with_laws.substr(0, with_laws.find("law =")), "m.toml");
  EXPECT_TRUE(s.laws.empty());
  EXPECT_EQ(s.machine.friction_N[0], 0.5);
  EXPECT_EQ(s.integrator, Integrator::event_driven);
}

TEST(MachineScenario, ReadsForcesAndImpulses) {
  const auto s = parse_machine_scenario(replaced(machine, "friction_N", "force_N = [1, -2]\nfriction_N") +
                                            "[[impulse]]\ntime_s = 1\nimpulse_Ns = [3, 0]\n"
                                            "[[impulse]]\ntime_s = 1\nimpulse_Ns = [0, 4]\n",
                                        "m.toml");
  EXPECT_EQ(s.machine.force_N, (Eigen::Vector2d{1, -2}));
  ASSERT_EQ(s.impulses.size(), 2U);
  EXPECT_EQ(s.impulses[1].impulse_Ns, (Eigen::Vector2d{0, 4}));
}

TEST(MachineScenario, RefusesLawsForcesAndImpulsesByName) {
  expect_refused(with_laws + "[run]\nintegrator = \"event_driven\"\n", "integrator = \"event_driven\" knows constant");
  expect_refused(with_laws + "[run]\nintegrator = \"time_stepping\"\n",
                 "integrator = \"time_stepping\" knows constant");
  expect_refused(with_laws + "[[machine.friction]]\nlower_N = 1\nupper_N = 2\n", "friction has 2 entries, must have 1");
  expect_refused(replaced(with_laws, "[[machine", "friction_N = [1]\n[[machine"), "friction stands beside friction_N");
  expect_refused(replaced(with_laws, "0.25", "0.75"), "[machine.friction] lower_N is 0.75 and exceeds upper_N = 0.5");
  expect_refused(replaced(with_laws, "stribeck", "stribek"), "stribek");
  expect_refused(replaced(with_laws, "lower_N", "mu_lower"), "mu_lower is not a key");
  expect_refused(machine + "[run]\ntolerance = 1e-9\n", "tolerance needs integrator = \"adaptive\"");
  expect_refused(with_laws + "[run]\ntolerance = 1e-15\n", "tolerance");
  expect_refused(replaced(machine, "friction_N", "force_N = [1]\nfriction_N"), "force_N is 1 x 1");
  expect_refused(machine + "[[impulse]]\ntime_s = 1\nimpulse_Ns = [1]\n", "impulse_Ns is 1 x 1, must be 2 x 1");
  expect_refused(machine + "[[impulse]]\ntime_s = 61\nimpulse_Ns = [1, 1]\n", "time_s is 61");
  expect_refused(machine + "[[impulse]]\nimpulse_Ns = [1, 1]\n", "time_s is missing");
  expect_refused(
      machine + "[[impulse]]\ntime_s = 2\nimpulse_Ns = [1, 1]\n[[impulse]]\ntime_s = 1\nimpulse_Ns = [1, 1]\n",
      "time_s is 1, before that of the entry above");
}

}  // namespace
