#include "configuration.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

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

std::string changed_scene(const std::string& from, const std::string& to) {
  std::ostringstream text;
  text << std::ifstream{folder + "can_axis.toml"}.rdbuf();
  std::string scene = text.str();
  const auto at = scene.find(from);
  EXPECT_NE(at, scene.npos) << from;
  scene.replace(at, from.size(), to);
  const std::string file = testing::TempDir() + "changed_scene.toml";
  std::ofstream{file} << scene;
  return file;
}

TEST(LinuxNodeConfiguration, ACertifiedSceneIsTakenAsItWouldBeFlashed) {
  const Configuration c = read_configuration(of(folder + "can_axis.toml"));
  EXPECT_EQ(breakaway::law::verify(c.axis), breakaway::law::FlashedAxisError::none);
  EXPECT_EQ(c.loop.period, std::chrono::milliseconds{1});
  EXPECT_EQ(c.drive.node_id, 1);
  EXPECT_FLOAT_EQ(c.scale().max_force_N, 50);
  EXPECT_FLOAT_EQ(c.limits.position_max_m, 10);
  EXPECT_DOUBLE_EQ(c.tolerance_m, 3e-6);
  EXPECT_FLOAT_EQ(c.force_per_per_mille_N, 0.025F);
  ASSERT_EQ(c.visits.size(), 1U);
  EXPECT_EQ(c.visits[0].counts, 0);
  EXPECT_TRUE(c.timed);
}

TEST(LinuxNodeConfiguration, TargetsBecomeWholeCounts) {
  Options options = of(folder + "can_axis.toml");
  options.targets_m = {0.25, -1e-6, 1.4e-6};
  const Configuration c = read_configuration(options);
  ASSERT_EQ(c.visits.size(), 3U);
  EXPECT_EQ(c.visits[0].counts, 250'000);
  EXPECT_EQ(c.visits[1].counts, -1);
  EXPECT_EQ(c.visits[2].counts, 1);
  EXPECT_FALSE(c.timed);
}

TEST(LinuxNodeConfiguration, ALowerForceLimitIsCoveredByTheCertificate) {
  Options options = of(folder + "can_axis.toml");
  options.max_force_N = 20;
  const Configuration c = read_configuration(options);
  EXPECT_FLOAT_EQ(c.scale().max_force_N, 20);
  EXPECT_FLOAT_EQ(c.axis.parameters.max_force_N, 20);
  EXPECT_EQ(breakaway::law::verify(c.axis), breakaway::law::FlashedAxisError::none);
}

TEST(LinuxNodeConfiguration, AForceLimitOutsideTheCertificateIsRefused) {
  for (const double force_N : {4.4, 50.1}) {
    Options options = of(folder + "can_axis.toml");
    options.max_force_N = force_N;
    EXPECT_NE(refusal(options).find("from 4.5 N, its upper friction bound, to 50 N"), std::string::npos) << force_N;
  }
}

TEST(LinuxNodeConfiguration, WhatIsNotCertifiedIsRefusedWithTheReason) {
  const std::string text = refusal(of(changed_scene("k22_Ns_per_m = 60", "k22_Ns_per_m = 300")));
  EXPECT_NE(text.find("not certified: "), std::string::npos) << text;
  EXPECT_NE(text.find("breakaway design"), std::string::npos) << text;
}

TEST(LinuxNodeConfiguration, ScenesThatNoNodeCanRunAreRefused) {
  EXPECT_NE(refusal(of(folder + "impulsive_example.toml")).find("has no [loop]"), std::string::npos);
  EXPECT_NE(refusal(of(folder + "can_axis_pid.toml")).find("pid"), std::string::npos);
  EXPECT_NE(refusal(of(folder + "none.toml")).find("cannot be read"), std::string::npos);
  Options far = of(folder + "can_axis.toml");
  far.targets_m = {10.1};
  EXPECT_NE(refusal(far).find("[limits] position_m = 10"), std::string::npos);
}

}  // namespace
