#include "configuration.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <variant>

#include "../scratch_folder.hpp"
#include "breakaway/config/new_node.hpp"
#include "breakaway/input/input_error.hpp"

namespace {

using namespace breakaway::linux_node;

const std::string folder = BREAKAWAY_SOURCE_DIR "/sim/scenarios/";

Options of(const std::string& file) {
  Options options;
  options.configuration = file;
  return options;
}

// The error's text; empty when there is none.
std::string refusal(const Options& options) {
  try {
    read_configuration(options);
  } catch (const breakaway::InputError& error) {
    return error.what();
  }
  return {};
}

std::string contents(const std::string& scenario) {
  std::ostringstream text;
  text << std::ifstream{folder + scenario}.rdbuf();
  return text.str();
}

const breakaway::config::AnyNode<float>& single(const Configuration& c) {
  return std::get<breakaway::config::AnyNode<float>>(c.node);
}

class LinuxNodeConfiguration : public breakaway::testing::ScratchFolder {
 protected:
  // Another file, with one change.
  std::string changed(const std::string& scenario, const std::string& from, const std::string& to) const {
    std::string text = contents(scenario);
    const auto at = text.find(from);
    EXPECT_NE(at, text.npos) << from;
    std::ofstream{path("changed.toml")} << text.replace(at, from.size(), to);
    return path("changed.toml");
  }
};

TEST_F(LinuxNodeConfiguration, OfAnOdriveIsCertifiedAndHasItsDriveBesideWhatIsFlashed) {
  Options options = of(folder + "polled_odrive.toml");
  Configuration c = read_configuration(options);
  ASSERT_TRUE(c.speaks_odrive());
  ASSERT_EQ(c.odrives.size(), 1U);
  EXPECT_EQ(c.node_id(0), 1);
  EXPECT_TRUE(single(c).axes[0].certified);
  EXPECT_FALSE(read_configuration(of(folder + "can_axis.toml")).speaks_odrive());
  options.node_id = 62;
  c = read_configuration(options);
  EXPECT_EQ(c.node_id(0), 62);
  options.node_id = 63;
  EXPECT_NE(refusal(options).find("--node-id 63: an ODrive has one of 0 to 62"), std::string::npos) << refusal(options);
  options.node_id = 0;
  options.max_force_N = 20;
  EXPECT_EQ(read_configuration(options).node_id(0), 0);
  EXPECT_LE(single(read_configuration(options)).axes[0].law.max_force_N, 20.0F);
}

TEST_F(LinuxNodeConfiguration, OfAnOdriveThatCannotBeCertifiedIsRefusedAndIdentified) {
  const Options options = of(folder + "odrive_axis.toml");
  EXPECT_NE(refusal(options).find("take estimates = \"polled\""), std::string::npos) << refusal(options);
  EXPECT_EQ(read_experiment(options).odrives.size(), 1U);
}

TEST_F(LinuxNodeConfiguration, AxesThatPushEachOtherAreTakenAsOneMachine) {
  const Configuration c = read_configuration(of(folder + "coupled_gantry.toml"));
  const auto* const machine = std::get_if<breakaway::config::MachineNode<float>>(&c.node);
  ASSERT_NE(machine, nullptr);
  EXPECT_TRUE(verify(*machine).ok());
  EXPECT_EQ(c.drive(1).node_id, 2);
  EXPECT_TRUE(c.drive(1).invert_direction);
  EXPECT_NEAR(c.axes[0].reached_m, 1.1e-5, 1e-12);
}

TEST_F(LinuxNodeConfiguration, ALoadOnASpringIsTakenUnderTheCoastWork) {
  const Configuration c = read_configuration(of(folder + "belt_axis.toml"));
  const auto* const belt = std::get_if<breakaway::config::WorkNode<float>>(&c.node);
  ASSERT_NE(belt, nullptr);
  EXPECT_TRUE(verify(*belt).ok());
  EXPECT_TRUE(belt->axes[0].kicks.metered);
  EXPECT_NEAR(c.axes[0].reached_m, 3.21e-4, 1e-12);
}

TEST_F(LinuxNodeConfiguration, ATourOfAMachineGoesNoFurtherAtOnceThanItIsCertifiedFor) {
  Options options = of(folder + "coupled_gantry.toml");
  options.targets = {"0.01", "0.03,0.04", "0.06,0.04"};
  EXPECT_EQ(read_configuration(options).axes[0].visits.size(), 3U);
  options.targets = {"0.01", "0.03,0.05"};
  EXPECT_NE(refusal(options).find("axis right goes from 0.01 m to 0.05 m at once"), std::string::npos)
      << refusal(options);
}

TEST_F(LinuxNodeConfiguration, ACertifiedNodeIsTakenAsItWouldBeFlashed) {
  const Configuration c = read_configuration(of(folder + "can_axis.toml"));
  EXPECT_TRUE(verify(single(c)).ok());
  EXPECT_EQ(single(c).count, 1);
  EXPECT_EQ(c.loop().network.period, std::chrono::milliseconds{1});
  EXPECT_EQ(single(c).axes[0].drive.node_id, 1);
  EXPECT_FLOAT_EQ(single(c).axes[0].scale().max_force_N, 50);
  EXPECT_FLOAT_EQ(single(c).axes[0].limits.position_max_m, 10);
  ASSERT_EQ(c.axes.size(), 1U);
  EXPECT_DOUBLE_EQ(c.axes[0].reached_m, 1.8e-6 + 1e-6)
      << "held half a count further away, which reads half a count more";
  EXPECT_FLOAT_EQ(c.axes[0].force_per_per_mille_N, 0.025F);
  ASSERT_EQ(c.axes[0].visits.size(), 1U);
  EXPECT_EQ(c.axes[0].visits[0].counts, 0);
  EXPECT_TRUE(c.timed);
}

TEST_F(LinuxNodeConfiguration, EveryAxisOfTheFileIsThereWithItsOwnTargets) {
  const Configuration c = read_configuration(of(folder + "three_axes.toml"));
  EXPECT_TRUE(verify(single(c)).ok());
  ASSERT_EQ(single(c).count, 3);
  ASSERT_EQ(c.axes.size(), 3U);
  EXPECT_EQ(c.axes[0].name, "gantry");
  EXPECT_EQ(c.axes[2].name, single(c).axes[2].name.view());
  EXPECT_EQ(c.axes[0].visits.size(), 2U);
  EXPECT_EQ(c.axes[1].visits.size(), 1U);
}

TEST_F(LinuxNodeConfiguration, TargetsBecomeWholeCounts) {
  Options options = of(folder + "can_axis.toml");
  options.targets = {"0.25", "-1e-6", "1.4e-6"};
  const Configuration c = read_configuration(options);
  const auto& visits = c.axes[0].visits;
  ASSERT_EQ(visits.size(), 3U);
  EXPECT_EQ(visits[0].counts, 250'000);
  EXPECT_EQ(visits[1].counts, -1);
  EXPECT_EQ(visits[2].counts, 1);
  EXPECT_FALSE(c.timed);
}

TEST_F(LinuxNodeConfiguration, OneTargetIsForAllAxesAndAListHasOneForEach) {
  Options options = of(folder + "three_axes.toml");
  options.targets = {"0.1", "0.1,-0.2,0.3"};
  const Configuration c = read_configuration(options);
  for (const auto& axis : c.axes) ASSERT_EQ(axis.visits.size(), 2U);
  EXPECT_EQ(c.axes[1].visits[0].counts, 100'000);
  EXPECT_EQ(c.axes[1].visits[1].counts, -200'000);
}

TEST_F(LinuxNodeConfiguration, TargetsThatAreNoPositionsForTheseAxesAreRefused) {
  const std::pair<const char*, const char*> bad[] = {
      {"0.1,0.2", "2 positions for 3 axes"},  {"0.1,x,0.2", "\"x\" is not a position"},
      {"0.1,,0.2", "\"\" is not a position"}, {"nan", "\"nan\" is not a position"},
      {"", "\"\" is not a position"},         {"0.1,0.6,0.1", "of axis slide: is beyond its [limits]"}};
  for (const auto& [target, expected] : bad) {
    Options options = of(folder + "three_axes.toml");
    options.targets = {target};
    EXPECT_NE(refusal(options).find(expected), std::string::npos) << target << ": " << refusal(options);
  }
}

TEST_F(LinuxNodeConfiguration, ALowerForceLimitIsCoveredByTheCertificate) {
  Options options = of(folder + "can_axis.toml");
  options.max_force_N = 20;
  const Configuration c = read_configuration(options);
  EXPECT_FLOAT_EQ(single(c).axes[0].scale().max_force_N, 20);
  EXPECT_TRUE(verify(single(c)).ok());
}

TEST_F(LinuxNodeConfiguration, AForceLimitOutsideTheCertificateIsRefused) {
  for (const double force_N : {4.4, 50.1}) {
    Options options = of(folder + "can_axis.toml");
    options.max_force_N = force_N;
    EXPECT_NE(refusal(options).find("has 50 N, and its upper friction bound is 4.5 N; choose one between"),
              std::string::npos)
        << force_N;
  }
}

// A drive's limit is a product, which rounding may leave below the number that the file says.
TEST_F(LinuxNodeConfiguration, TheForceLimitOfTheFileIsNoneThatIsRefused) {
  const breakaway::config::NewNode made = breakaway::config::new_node({12, 15, 28, 5e-7, 1000, 200, 0.4});
  ASSERT_LT(made.node.axes.front().drive->max_force_N(), 200) << "this file does not show it";
  std::ofstream{path("new.toml")} << made.text;
  Options options = of(path("new.toml"));
  options.max_force_N = 200;
  EXPECT_EQ(refusal(options), "");
}

TEST_F(LinuxNodeConfiguration, AnotherNodeIdIsForASingleAxisOnly) {
  Options options = of(folder + "can_axis.toml");
  options.node_id = 42;
  EXPECT_EQ(read_configuration(options).drive(0).node_id, 42);
  options.node_id = 0;
  EXPECT_NE(refusal(options).find("--node-id 0: a CANopen drive has one of 1 to 126"), std::string::npos);
  options.configuration = folder + "three_axes.toml";
  EXPECT_NE(refusal(options).find("--node-id: the file has several axes"), std::string::npos);
}

TEST_F(LinuxNodeConfiguration, WhatIsNotCertifiedIsRefusedWithTheReason) {
  const std::string text = refusal(of(changed("can_axis.toml", "k22_Ns_per_m = 60", "k22_Ns_per_m = 300")));
  EXPECT_NE(text.find("not certified: "), std::string::npos) << text;
  EXPECT_NE(text.find("breakaway design"), std::string::npos) << text;
  const std::string slide = refusal(of(changed("three_axes.toml", "k22_Ns_per_m = 180", "k22_Ns_per_m = 900")));
  EXPECT_NE(slide.find("axis slide: not certified: "), std::string::npos) << slide;
}

TEST_F(LinuxNodeConfiguration, FilesThatNoNodeCanRunAreRefused) {
  EXPECT_NE(refusal(of(folder + "impulsive_example.toml")).find("[loop] is missing"), std::string::npos);
  EXPECT_NE(refusal(of(folder + "can_axis_pid.toml")).find("pid"), std::string::npos);
  EXPECT_NE(refusal(of(folder + "none.toml")).find("cannot be read"), std::string::npos);
  Options far = of(folder + "can_axis.toml");
  far.targets = {"10.1"};
  EXPECT_NE(refusal(far).find("its [limits], position_m = -10 to 10"), std::string::npos) << refusal(far);
}

TEST_F(LinuxNodeConfiguration, AnExperimentNeedsNoCertificateAndKeepsTheGuardsOfTheFile) {
  Options options = of(changed("can_axis.toml", "position_tolerance_m = 1.8e-6", "position_tolerance_m = 1e-9"));
  ASSERT_NE(refusal(options), "");
  options.identify = true;
  options.max_force_N = 20;
  const Configuration c = read_experiment(options);
  const auto& node = std::get<ExperimentNode>(c.node);
  EXPECT_EQ(c.loop().network.period, std::chrono::milliseconds{1});
  EXPECT_EQ(c.drive(0).node_id, 1);
  EXPECT_FLOAT_EQ(node.axes[0].limits.position_max_m, 10);
  EXPECT_FLOAT_EQ(node.axes[0].limits.speed_m_s, 20);
  EXPECT_FLOAT_EQ(node.experiment.max_force_N, 20);
  EXPECT_FLOAT_EQ(node.experiment.lowest_m, -10);
  EXPECT_FLOAT_EQ(node.experiment.period_s, 1e-3F);
}

TEST_F(LinuxNodeConfiguration, AnExperimentIsOfOneAxisThatIsNamed) {
  Options options = of(folder + "two_axes.toml");
  options.identify = true;
  const auto refused = [&] {
    try {
      read_experiment(options);
    } catch (const breakaway::InputError& error) {
      return std::string{error.what()};
    }
    return std::string{};
  };
  EXPECT_NE(refused().find("two_axes.toml: has several axes: say which to identify with --axis NAME"),
            std::string::npos)
      << refused();
  options.axis = "y";
  const Configuration c = read_experiment(options);
  EXPECT_EQ(c.axes.front().name, "y");
  EXPECT_EQ(std::get<ExperimentNode>(c.node).axes[0].name.view(), "y");
  EXPECT_EQ(c.drive(0).node_id, 2);
  options.axis = "nobody";
  EXPECT_NE(refused().find("two_axes.toml: has no axis \"nobody\""), std::string::npos) << refused();
  options.axis = "y";
  options.targets = {"0.1"};
  EXPECT_NE(refused().find("--target: an experiment goes where it has to"), std::string::npos) << refused();
  options = of(folder + "coupled_gantry.toml");
  options.axis = "left";
  EXPECT_NE(refused().find("push each other: see [coupling]"), std::string::npos) << refused();
}

}  // namespace
