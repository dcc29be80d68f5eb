// The example of section V of van de Wouw & Leine against values of an independent computation in 100-digit arithmetic
// (tests/reference/impulsive_example.py), and what the ideal law promises elsewhere.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_ideal_scenario.hpp"

namespace {

using breakaway::scenario::read_scenario;
using breakaway::scenario::Scenario;
using breakaway::sil::AxisResult;
using breakaway::sil::run_ideal_scenario;

AxisResult run_ideal(const Scenario& s, const breakaway::sil::RecordingOptions& recording = {}) {
  return run_ideal_scenario(s, recording).axes.front();
}

Scenario example() { return read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/impulsive_example.toml"); }

struct Reference {
  std::map<std::string, double> figures;
  std::vector<std::array<double, 3>> kicks;
};

Reference reference() {
  std::ifstream in{BREAKAWAY_SOURCE_DIR "/tests/reference/impulsive_example.csv"};
  Reference reference;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells{line};
    std::string name, cell;
    std::getline(cells, name, ',');
    std::vector<double> numbers;
    while (name[0] != '#' && std::getline(cells, cell, ',')) numbers.push_back(std::stod(cell));
    if (numbers.size() == 1) reference.figures[name] = numbers[0];
    if (numbers.size() == 3) reference.kicks.push_back({numbers[0], numbers[1], numbers[2]});
  }
  return reference;
}

void expect_relative(double value, double expected, const std::string& what) {
  EXPECT_NEAR(value, expected, 1e-9 * std::fabs(expected)) << what;
}

TEST(IdealScenario, AgreesWithTheIndependentComputationOfTheExample) {
  const Reference expected = reference();
  const AxisResult result = run_ideal(example());
  ASSERT_TRUE(result.settled);
  expect_relative(result.ideal->t1_s, expected.figures.at("t1_s"), "t1");
  expect_relative(result.ideal->t2_s, expected.figures.at("t2_s"), "t2");
  expect_relative(result.ideal->y2_m, expected.figures.at("y2_m"), "y2");
  expect_relative(result.ideal->t_inf_s, expected.figures.at("t_inf_s"), "t_inf");
  expect_relative(result.ideal->bound_s, expected.figures.at("bound_s"), "bound");
  ASSERT_GE(result.kicks.size(), expected.kicks.size());
  ASSERT_GE(expected.kicks.size(), 20u);
  for (std::size_t i = 0; i < expected.kicks.size(); ++i) {
    const auto& [time_s, position_m, velocity_m_s] = expected.kicks[i];
    expect_relative(result.kicks[i].time_s, time_s, "time of kick " + std::to_string(i));
    expect_relative(result.kicks[i].position_m, position_m, "position of kick " + std::to_string(i));
    expect_relative(result.kicks[i].velocity_after_m_s, velocity_m_s, "velocity after kick " + std::to_string(i));
  }
}

TEST(IdealScenario, EndsOnTheCertificateAtTheResolutionOfTime) {
  const AxisResult result = run_ideal(example());
  EXPECT_LT(result.ideal->t_inf_width_s, 1e-15);  // one ulp of 4.9 s is 8.9e-16
  EXPECT_LT(std::fabs(result.final_error_m), 1e-29);
  EXPECT_LE(result.ideal->t_inf_s, result.ideal->bound_s);
}

// Friction at its lower bound is what k3 is computed for: one kick, and only the rounding of that is left.
TEST(IdealScenario, NeedsOneKickUnderTheLeastFriction) {
  Scenario s = example();
  s.worlds.front().position_m = -1;
  s.worlds.front().velocity_m_s = 0;
  s.worlds.front().friction = {{2.5, 4.5}, breakaway::model::shape::constant(0)};
  const AxisResult result = run_ideal(s);
  ASSERT_TRUE(result.settled);
  ASSERT_GE(result.kicks.size(), 2u);
  EXPECT_LT(std::fabs(result.kicks[1].error_m), 1e-12);
}

TEST(IdealScenario, RecordsATraceOnlyOnRequestAndWithoutChangingTheResult) {
  const AxisResult bare = run_ideal(example());
  const AxisResult traced = run_ideal(example(), {.trace = true});
  EXPECT_TRUE(bare.trace.empty());
  ASSERT_GT(traced.trace.size(), 1000u);
  EXPECT_EQ(traced.kicks.size(), bare.kicks.size());
  EXPECT_NEAR(traced.ideal->t_inf_s, bare.ideal->t_inf_s, 1e-12);
  for (const auto& sample : traced.trace) {
    EXPECT_GE(sample.friction_level_N, 2.5);
    EXPECT_LE(sample.friction_level_N, 4.5);
  }
}

TEST(IdealScenario, HasSettledWhenItStartsAtRestOnTheTarget) {
  Scenario s = example();
  s.worlds.front().position_m = s.worlds.front().velocity_m_s = 0;
  const AxisResult result = run_ideal(s);
  EXPECT_TRUE(result.settled);
  EXPECT_EQ(result.ideal->t_inf_s, 0);
  EXPECT_TRUE(result.kicks.empty());
}

TEST(IdealScenario, DoesNotClaimToHaveSettledWhenTimeRunsOut) {
  Scenario s = example();
  s.run->duration_s = 4;
  const AxisResult result = run_ideal(s);
  EXPECT_FALSE(result.settled);
  EXPECT_TRUE(std::isnan(result.settling_time_s));
  EXPECT_DOUBLE_EQ(run_ideal_scenario(s, {}).duration_s, 4);
}

TEST(IdealScenario, FollowsATargetThatChangesOnTheWayAndAfterSettling) {
  Scenario s = example();
  s.node.axes.front().controller.target_m = 1;
  s.node.axes.front().controller.targets = {{.time_s = 2, .position_m = 0.5}, {.time_s = 12, .position_m = -3}};
  const AxisResult result = run_ideal(s);
  ASSERT_TRUE(result.settled);
  EXPECT_NEAR(result.final_error_m, 0, 1e-14);  // the resolution of positions near -3 m
  EXPECT_GT(result.ideal->t_inf_s, 12);
  EXPECT_NEAR(result.settling_time_s, result.ideal->t_inf_s - 12, 1e-12);
}

// The law promises a finite time for every friction within the bounds: random dwell laws, seeded.
TEST(IdealScenario, SettlesWithinTheBoundUnderRandomFriction) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Scenario s = example();
    s.worlds.front().friction = {{2.5, 4.5}, breakaway::model::shape::random_dwell({.seed = seed})};
    const AxisResult result = run_ideal(s);
    ASSERT_TRUE(result.settled) << "seed " << seed;
    EXPECT_LE(result.ideal->t_inf_s, result.ideal->bound_s) << "seed " << seed;
  }
}

// Told a lighter mass, its kicks are too weak by that share, and what is left is kicked again.
TEST(IdealScenario, BearsAMassThatItIsNotTold) {
  Scenario s = example();
  auto& axis = s.node.axes.front();
  axis.truth = breakaway::config::truth_of(axis);
  axis.mass_kg *= 0.9;
  axis.controller.impulsive->kick_damping_Ns_per_m *= 1.2;
  const AxisResult result = run_ideal(s);
  EXPECT_TRUE(result.settled);
  EXPECT_EQ(result.told, "mass_kg 0.9 (truly 1)");
  EXPECT_TRUE(std::isnan(result.ideal->bound_s)) << "the bound is proved for what is told";
  EXPECT_GT(result.kicks.size(), run_ideal(example()).kicks.size() / 2);
}

// The same truth, told in so many words, changes nothing.
TEST(IdealScenario, IsTheSameWhenItIsToldTheTruth) {
  Scenario s = example();
  s.node.axes.front().truth = breakaway::config::truth_of(s.node.axes.front());
  const AxisResult told = run_ideal(s), plain = run_ideal(example());
  EXPECT_EQ(told.settling_time_s, plain.settling_time_s);
  EXPECT_EQ(told.ideal->bound_s, plain.ideal->bound_s);
  EXPECT_EQ(told.told, "");
}

// Far from the target the axis slides where spring and force balance: with friction f and force F it first rests within
// (f + |F|)/k1, and a force beyond friction never lets it rest on the target.
TEST(IdealScenario, FeelsAConstantForceThatItDoesNotKnow) {
  Scenario s = example();
  s.worlds.front().friction = {{2.5, 4.5}, breakaway::model::shape::constant(0)};
  s.worlds.front().plant.force_N = 0.2;
  const AxisResult light = run_ideal(s);
  EXPECT_TRUE(light.settled);
  EXPECT_TRUE(std::isnan(light.ideal->bound_s));
  s.worlds.front().plant.force_N = 5;
  const AxisResult heavy = run_ideal(s);
  EXPECT_FALSE(heavy.settled);
  const double stiffness_N_per_m = s.node.axes.front().controller.impulsive->stiffness_N_per_m;
  EXPECT_NEAR(heavy.final_error_m, 5 / stiffness_N_per_m, 2.5 / stiffness_N_per_m)
      << "the spring holds what friction leaves of the force";
}

}  // namespace
