#include "breakaway/odrive/drive_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "obedient_node.hpp"

namespace breakaway::odrive::test {
namespace {

struct Spoiled {
  DriveConfigError error;
  void (*spoil)(DriveConfig<float>&, hal::NetworkConfig&, hal::AxisScale<float>&);
};

TEST(OdriveConfig, NamesTheFieldThatCannotBeUsed) {
  const std::vector<Spoiled> table{
      {DriveConfigError::node_id, [](auto& c, auto&, auto&) { c.node_id = 63; }},
      {DriveConfigError::heartbeat_timeout, [](auto& c, auto&, auto&) { c.heartbeat_timeout = 100ms; }},
      {DriveConfigError::heartbeat_timeout, [](auto& c, auto&, auto&) { c.heartbeat_period = 0ms; }},
      {DriveConfigError::period, [](auto&, auto& n, auto&) { n.period = 0ms; }},
      {DriveConfigError::estimate_period, [](auto& c, auto&, auto&) { c.estimate_period = 2ms; }},
      {DriveConfigError::encoder_resolution, [](auto&, auto&, auto& s) { s.encoder_resolution_m = NAN; }},
      {DriveConfigError::counts_per_turn, [](auto& c, auto&, auto&) { c.counts_per_turn = HUGE_VAL; }},
      {DriveConfigError::force_per_torque, [](auto& c, auto&, auto&) { c.force_per_torque_N_per_Nm = 0; }},
      {DriveConfigError::max_torque, [](auto& c, auto&, auto&) { c.max_torque_Nm = -1; }},
      {DriveConfigError::max_force, [](auto&, auto&, auto& s) { s.max_force_N = NAN; }},
      {DriveConfigError::limits, [](auto& c, auto&, auto&) { c.current_limit_A = 3; }},
      {DriveConfigError::limits, [](auto& c, auto&, auto&) { c.current_limit_A = c.velocity_limit_turns_s = NAN; }},
  };
  std::set<std::string_view> sentences;
  for (const Spoiled& row : table) {
    auto c = config;
    auto n = network;
    auto s = scale;
    row.spoil(c, n, s);
    EXPECT_EQ(check(c, n, s), row.error) << to_string(row.error);
    sentences.insert(to_string(row.error));
    Drive<float> drive{c, n, s};
    EXPECT_EQ(drive.feedback().state, hal::DriveState::unusable);
    EXPECT_EQ(drive.setup_status(), SetupStatus::config_invalid);
    hal::CanFrame frame;
    drive.on_frame({ObedientNode{}.heartbeat(), {}});
    drive.update({});
    EXPECT_FALSE(drive.next_command_frame(frame) || drive.next_acyclic_frame(frame, {}) ||
                 drive.next_poll_frame(frame));
  }
  EXPECT_EQ(sentences.size(), 10U);
}

TEST(OdriveConfig, LetsACyclicDriveSendFasterThanTheLoop) {
  auto c = config;
  auto n = network;
  n.period = 2ms;
  EXPECT_EQ(check(c, n, scale), DriveConfigError::none);
}

TEST(OdriveConfig, OfADriveThatCannotStepFinelyEnoughMakesItUnusable) {
  auto s = scale;
  s.max_force_N = 1e-3F;
  Drive<float> drive{config, network, s};
  EXPECT_EQ(drive.feedback().state, hal::DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
}

}  // namespace
}  // namespace breakaway::odrive::test
