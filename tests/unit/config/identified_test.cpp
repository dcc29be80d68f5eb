#include "breakaway/config/identified.hpp"

#include <gtest/gtest.h>

#include <string>

#include "../refusal.hpp"
#include "breakaway/config/experiment.hpp"
#include "breakaway/config/file_contents.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

using breakaway::testing::refusal;

const std::string folder = BREAKAWAY_SOURCE_DIR "/sim/scenarios/";

const IdentifiedAxis found{.mass_kg = 1.25,
                           .mass_uncertainty = 0.012,
                           .friction_lower_N = 2.34567,
                           .friction_upper_N = 5.43212,
                           .lag_s = 2.5e-4,
                           .lag_uncertainty = 0.31};

Node with_found(const std::string& text, const std::string& axis = "") {
  return parse_node(with_identified(text, "identified", axis, found), "identified");
}

void expect_found(const Axis& axis) {
  EXPECT_DOUBLE_EQ(axis.mass_kg, 1.25);
  EXPECT_NEAR(axis.friction.bounds.lower_N, 2.34567, 1e-3);
  EXPECT_LE(axis.friction.bounds.lower_N, 2.34567);
  EXPECT_NEAR(axis.friction.bounds.upper_N, 5.43212, 1e-3);
  EXPECT_GE(axis.friction.bounds.upper_N, 5.43212);
  EXPECT_DOUBLE_EQ(axis.uncertainty.mass, 0.012);
  EXPECT_DOUBLE_EQ(axis.drive->current_loop_time_constant_s, 2.5e-4);
  EXPECT_GE(axis.uncertainty.current_loop_time_constant, 0.31);
}

TEST(WithIdentified, KeepsCoefficientsCommentsAndTheDampingRatios) {
  const std::string before = file_contents(folder + "braked_axis.toml");
  const Node node = with_found(before), old = parse_node(before, "before");
  expect_found(node.axes.front());
  const ImpulsiveGains &gains = *node.axes.front().controller.impulsive,
                       &known = *old.axes.front().controller.impulsive;
  EXPECT_NEAR(gains.stiffness_N_per_m, 1.25 * known.stiffness_N_per_m, 1e-3);
  EXPECT_NEAR(gains.kick_damping_Ns_per_m, 1.25 * known.kick_damping_Ns_per_m, 1e-3);
  const std::string after = with_identified(before, "identified", "", found);
  EXPECT_NE(after.find("# a drum of 20 mm radius"), std::string::npos);
  EXPECT_NE(after.find("gravity_m_s2 = 10"), std::string::npos);
}

TEST(WithIdentified, AddsTheTablesThatAreMissing) {
  const Node node = with_found(file_contents(folder + "can_axis.toml"));
  expect_found(node.axes.front());
}

TEST(WithIdentified, TouchesOneAxisOfSeveral) {
  const std::string before = file_contents(folder + "two_axes.toml");
  const Node old = parse_node(before, "before");
  const Node node = with_found(before, old.axes.back().name);
  expect_found(node.axes.back());
  EXPECT_EQ(node.axes.front().mass_kg, old.axes.front().mass_kg);
  EXPECT_EQ(node.axes.front().friction.bounds.upper_N, old.axes.front().friction.bounds.upper_N);
  EXPECT_THROW(with_identified(before, "identified", "nobody", found), InputError);
}

TEST(WithIdentified, TellsTheNodeAndLeavesTheTruthWhereTheFileHasBoth) {
  const std::string before = file_contents(folder + "can_axis.toml") + "\n[told]\nmass_kg = 1.1 # \xC3\xA4hnlich\n";
  const Node node = with_found(before);
  expect_found(node.axes.front());
  EXPECT_DOUBLE_EQ(truth_of(node.axes.front()).mass_kg, 1);
}

TEST(ExperimentParameters, NameTheLimitThatIsMissing) {
  Node node = read_node(folder + "braked_axis.toml");
  EXPECT_DOUBLE_EQ(experiment_parameters<double>(node, node.axes.front(), {}).highest_m, 10);
  const ExperimentRequest narrow{.lowest_m = -0.5, .highest_m = 9};
  EXPECT_DOUBLE_EQ(experiment_parameters<double>(node, node.axes.front(), narrow).lowest_m, -0.5);
  EXPECT_DOUBLE_EQ(experiment_parameters<double>(node, node.axes.front(), narrow).highest_m, 9);
  node.axes.front().limits.speed_m_s = unlimited;
  EXPECT_THROW(experiment_parameters<double>(node, node.axes.front(), {}), InputError);
  node.axes.front().limits = {.position_min_m = -1, .speed_m_s = 1};
  EXPECT_THROW(experiment_parameters<double>(node, node.axes.front(), {}), InputError);
}

TEST(ExperimentParameters, RefuseATravelBeyondTheLimitsOfTheFile) {
  const Node node = read_node(folder + "braked_axis.toml");
  const auto why = [&](const ExperimentRequest& request) {
    return refusal([&] { experiment_parameters<double>(node, node.axes.front(), request); });
  };
  EXPECT_NE(why({.lowest_m = -0.5, .highest_m = 11}).find("ends at 11 m, beyond [limits] position_max_m = 10"),
            std::string::npos);
  EXPECT_NE(why({.lowest_m = -11}).find("ends at -11 m, beyond [limits] position_min_m = -10"), std::string::npos);
  EXPECT_NE(why({.lowest_m = 2, .highest_m = 1}).find("from 2 to 1 m is empty"), std::string::npos);
  EXPECT_EQ(why({.lowest_m = -10, .highest_m = 10}), "");
}

}  // namespace
}  // namespace breakaway::config
