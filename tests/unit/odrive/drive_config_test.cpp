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
      {DriveConfigError::estimate_period, [](auto& c, auto&, auto&) { c.estimate_period = 0ms; }},
      {DriveConfigError::encoder_resolution, [](auto&, auto&, auto& s) { s.encoder_resolution_m = NAN; }},
      {DriveConfigError::counts_per_turn, [](auto& c, auto&, auto&) { c.counts_per_turn = HUGE_VAL; }},
      {DriveConfigError::force_per_torque, [](auto& c, auto&, auto&) { c.force_per_torque_N_per_Nm = 0; }},
      {DriveConfigError::max_torque, [](auto& c, auto&, auto&) { c.max_torque_Nm = -1; }},
      {DriveConfigError::max_force, [](auto&, auto&, auto& s) { s.max_force_N = NAN; }},
      {DriveConfigError::limits, [](auto& c, auto&, auto&) { c.current_limit_A = 3; }},
      {DriveConfigError::limits, [](auto& c, auto&, auto&) { c.velocity_limit_turns_s = 3; }},
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

// What each of them says is what the reader of a log goes by.
TEST(OdriveConfig, SaysWhatEachFieldMustBe) {
  struct Row {
    DriveConfigError error;
    std::string_view what, must;
  };
  for (const Row& row :
       {Row{DriveConfigError::none, "configuration", "can be used"},
        Row{DriveConfigError::node_id, "node_id", "0 to 62"},
        Row{DriveConfigError::heartbeat_timeout, "heartbeat_timeout", "longer than the drive's heartbeat_period"},
        Row{DriveConfigError::estimate_period, "estimate_period", "at most the loop's period"},
        Row{DriveConfigError::period, "period", "above 0"},
        Row{DriveConfigError::encoder_resolution, "encoder_resolution_m", "above 0"},
        Row{DriveConfigError::counts_per_turn, "counts_per_turn", "above 0"},
        Row{DriveConfigError::force_per_torque, "force_per_torque_N_per_Nm", "above 0"},
        Row{DriveConfigError::max_torque, "max_torque_Nm", "above 0"},
        Row{DriveConfigError::max_force, "max_force_N", "above 0"},
        Row{DriveConfigError::limits, "current_limit_A", "both be 0"},
        Row{static_cast<DriveConfigError>(200), "unknown", "error"}}) {
    EXPECT_NE(to_string(row.error).find(row.what), std::string_view::npos) << row.what;
    EXPECT_NE(to_string(row.error).find(row.must), std::string_view::npos) << row.what;
  }
}

TEST(OdriveConfig, TakesTheWholeOfEachRange) {
  const std::vector<void (*)(DriveConfig<float>&, hal::NetworkConfig&, hal::AxisScale<float>&)> edges{
      [](auto& c, auto&, auto&) { c.node_id = 0; },
      [](auto& c, auto&, auto&) { c.node_id = 62; },
      [](auto& c, auto&, auto&) { c.heartbeat_timeout = c.heartbeat_period + 1ns; },
      [](auto& c, auto&, auto&) { c.heartbeat_period = 1ns; },
      [](auto& c, auto& n, auto&) { n.period = c.estimate_period = 1ns; },
      [](auto& c, auto& n, auto&) { c.estimate_period = n.period; },
      [](auto& c, auto&, auto&) { c.estimate_period = 1ns; },
      [](auto& c, auto&, auto&) { c.max_torque_Nm = std::numeric_limits<float>::max(); },
      [](auto& c, auto&, auto&) { c.max_torque_Nm = std::numeric_limits<float>::denorm_min(); },
      [](auto& c, auto&, auto&) { c.current_limit_A = c.velocity_limit_turns_s = 0.5F; },
      [](auto& c, auto&, auto&) { c.estimates = Estimates::polled, c.estimate_period = 0ns; },
  };
  for (std::size_t i = 0; i < edges.size(); ++i) {
    auto c = config;
    auto n = network;
    auto s = scale;
    edges[i](c, n, s);
    EXPECT_EQ(check(c, n, s), DriveConfigError::none) << i;
  }
}

TEST(OdriveConfig, RefusesWhatIsJustBeyond) {
  auto c = config;
  c.estimate_period = -1ns;
  EXPECT_EQ(check(c, network, scale), DriveConfigError::estimate_period);
  c.estimate_period = network.period + 1ns;
  EXPECT_EQ(check(c, network, scale), DriveConfigError::estimate_period);
  c = config;
  c.heartbeat_period = c.heartbeat_timeout = 0ns;
  EXPECT_EQ(check(c, network, scale), DriveConfigError::heartbeat_timeout);
  c = config;
  c.velocity_limit_turns_s = 3;
  c.current_limit_A = -1;
  EXPECT_EQ(check(c, network, scale), DriveConfigError::limits);
}

TEST(OdriveConfig, IsThatOfANewDriveUnlessTold) {
  const DriveConfig<float> untold;
  EXPECT_EQ(untold.node_id, 1);
  EXPECT_EQ(untold.velocity_limit_turns_s, 0);
  EXPECT_EQ(untold.current_limit_A, 0);
  EXPECT_EQ(untold.estimates, Estimates::cyclic);
  EXPECT_EQ(untold.estimate_period, 1ms);
  EXPECT_EQ(untold.heartbeat_period, 100ms);
  EXPECT_EQ(untold.heartbeat_timeout, 250ms);
  EXPECT_FALSE(untold.invert_direction || untold.absolute_encoder || untold.home_here);
  EXPECT_EQ(untold.home_counts, 0);
}

TEST(OdriveConfig, LetsACyclicDriveSendFasterThanTheLoop) {
  auto c = config;
  auto n = network;
  n.period = 2ms;
  EXPECT_EQ(check(c, n, scale), DriveConfigError::none);
}

TEST(OdriveConfig, OfATorqueWhoseStepsANumberHardlyHoldsMakesItUnusable) {
  auto c = config;
  c.max_torque_Nm = 1e-36F;
  Drive<float> drive{c, network, scale};
  EXPECT_EQ(drive.feedback().state, hal::DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
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
