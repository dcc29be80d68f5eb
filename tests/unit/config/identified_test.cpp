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

TEST(WithIdentified, EntersBothSidesOfALoadOnASpringAndTellsTheirSum) {
  IdentifiedAxis sprung = found;
  sprung.spring = IdentifiedSpring{.motor_kg = 0.5,
                                   .load_kg = 0.75,
                                   .stiffness_N_per_m = 30'680,
                                   .least_seen_N_per_m = 34'090,
                                   .damping_Ns_per_m = 1.77,
                                   .motor_lower_N = 1.5,
                                   .motor_upper_N = 2.5,
                                   .load_lower_N = 1.25,
                                   .load_upper_N = 2.25};
  const std::string before = file_contents(folder + "belt_axis.toml");
  const std::string text = with_identified(before, "identified", "", sprung);
  const Axis axis = parse_node(text, "identified").axes.front();
  EXPECT_DOUBLE_EQ(axis.mass_kg, 1.25);
  EXPECT_DOUBLE_EQ(axis.friction.bounds.lower_N, 2.75);
  EXPECT_DOUBLE_EQ(axis.friction.bounds.upper_N, 4.75);
  EXPECT_DOUBLE_EQ(truth_of(axis).mass_kg, 0.5);
  EXPECT_DOUBLE_EQ(truth_of(axis).bounds.upper_N, 2.5);
  ASSERT_TRUE(axis.surroundings.load);
  EXPECT_DOUBLE_EQ(axis.surroundings.load->load_kg, 0.75);
  EXPECT_DOUBLE_EQ(axis.surroundings.load->stiffness_N_per_m, 30'600);
  EXPECT_DOUBLE_EQ(axis.surroundings.load->damping_Ns_per_m, 1.7);
  EXPECT_DOUBLE_EQ(axis.surroundings.load->load_friction.lower_N, 1.25);
  EXPECT_NE(text.find("stiffness_N_per_m = 30600 # at least"), std::string::npos) << text;
  EXPECT_DOUBLE_EQ(axis.controller.impulsive->stiffness_N_per_m, 500);
}

TEST(WithIdentified, EntersALoadThatStandsInlineInAnAxisOfSeveral) {
  IdentifiedAxis sprung = found;
  sprung.spring = IdentifiedSpring{0.5, 0.75, 3e4, 3.4e4, 1, 1.5, 2.5, 1.25, 2.25};
  std::string text = file_contents(folder + "two_axes.toml");
  const std::string inline_mass = "plant = { mass_kg = 3,";
  text.replace(text.find(inline_mass), inline_mass.size(),
               "plant = { load = { mass_kg = 1, stiffness_N_per_m = 1e4, friction_lower_N = 1, friction_upper_N = 2 }, "
               "mass_kg = 3,");
  const std::string name = parse_node(file_contents(folder + "two_axes.toml"), "before").axes.back().name;
  const Node node = parse_node(with_identified(text, "identified", name, sprung), "identified");
  EXPECT_DOUBLE_EQ(node.axes.back().surroundings.load->load_kg, 0.75);
  EXPECT_DOUBLE_EQ(node.axes.back().mass_kg, 1.25);
  EXPECT_FALSE(node.axes.front().surroundings.load);
}

TEST(WithIdentified, AStiffnessAboveWhatWasSeenIsRefused) {
  std::string text = file_contents(folder + "belt_axis.toml");
  text.insert(text.find("damping_Ns_per_m = 3.6"), "stiffness_seen_N_per_m = 3.3e4\n");
  try {
    static_cast<void>(parse_node(text, "belt"));
    FAIL() << "it is taken";
  } catch (const InputError& refusal) {
    const std::string said = refusal.what();
    EXPECT_NE(said.find("34000 and exceeds stiffness_seen_N_per_m = 33000"), std::string::npos) << said;
    EXPECT_NE(said.find("lower bound"), std::string::npos) << said;
  }
}

TEST(ExperimentParameters, TakeALoadBehindTheMotorAndRefuseAnEncoderOnTheLoad) {
  Node node = read_node(folder + "belt_axis.toml");
  EXPECT_TRUE(experiment_parameters<double>(node, node.axes.front(), {}).load_on_spring);
  node.axes.front().surroundings.load->encoder_on_load = true;
  EXPECT_THROW(experiment_parameters<double>(node, node.axes.front(), {}), InputError);
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
  EXPECT_NE(why({.lowest_m = -0.5, .highest_m = 11}).find("ends at 11 m, beyond the upper end of [limits], 10 m"),
            std::string::npos);
  EXPECT_NE(why({.lowest_m = -11}).find("ends at -11 m, beyond the lower end of [limits], -10 m"), std::string::npos);
  EXPECT_NE(why({.lowest_m = 2, .highest_m = 1}).find("from 2 to 1 m is empty"), std::string::npos);
  EXPECT_EQ(why({.lowest_m = -10, .highest_m = 10}), "");
}

}  // namespace
}  // namespace breakaway::config
