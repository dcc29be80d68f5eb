// A drive, the node at the far end of its wire and the periods of the loop, for the tests of cia402::Drive.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <vector>

#include "breakaway/cia402/drive.hpp"
#include "scripted_drive.hpp"

namespace breakaway::test {

using namespace std::chrono_literals;
using breakaway::canopen::emcy_cob_id;
using breakaway::canopen::heartbeat_cob_id;
using breakaway::canopen::is_sync;
using breakaway::canopen::NmtCommand;
using breakaway::canopen::NmtState;
using breakaway::canopen::ObjectAddress;
using breakaway::canopen::rpdo_cob_id;
using breakaway::canopen::sdo_request_cob_id;
using breakaway::canopen::sdo_response_cob_id;
using breakaway::canopen::SdoAbort;
using breakaway::canopen::tpdo_cob_id;
using breakaway::cia402::Drive;
using breakaway::cia402::DriveConfig;
using breakaway::cia402::DriveConfigError;
using breakaway::cia402::SetupStatus;
using breakaway::cia402::State;
using breakaway::hal::AxisScale;
using breakaway::hal::CanFrame;
using breakaway::hal::DriveFeedback;
using breakaway::hal::DriveState;
using breakaway::hal::Duration;
using breakaway::hal::NetworkConfig;
using breakaway::hal::Time;

inline constexpr std::uint8_t node_id = 4;

// 1 um a count, 50 N at the rated torque: 0.05 N a per mille.
inline constexpr DriveConfig<float> config{.node_id = node_id, .force_per_torque_N_per_Nm = 50.0F};
inline constexpr NetworkConfig network{.period = 1ms};
inline constexpr AxisScale<float> scale{.encoder_resolution_m = 1e-6F, .max_force_N = 60.0F};
static_assert(check(config, network, scale) == DriveConfigError::none);

class DriveTest : public testing::Test {
 protected:
  explicit DriveTest(const DriveConfig<float>& drive_config = config, const AxisScale<float>& axis_scale = scale)
      : drive{drive_config, network, axis_scale} {}

  Drive<float> drive;
  ScriptedDrive node{node_id};
  Time now{};
  DriveFeedback<float> feedback{};
  std::vector<CanFrame> sent;

  void deliver() {
    std::vector<CanFrame> frames;
    frames.swap(node.out);
    for (const CanFrame& frame : frames) drive.on_frame({.frame = frame, .time = now + 300us});
  }
  void send(const CanFrame& frame) {
    sent.push_back(frame);
    node.on_frame(frame);
  }
  // One period of the control loop.
  void step(std::optional<float> force_N = std::nullopt) {
    now += 1ms;
    node.advance_to(now);
    drive.update(now);
    feedback = drive.feedback();
    if (force_N) drive.command(*force_N);
    sent.clear();
    send(breakaway::canopen::sync_frame());
    drive.on_sync(now);
    CanFrame frame;
    if (drive.next_command_frame(frame)) send(frame);
    if (drive.next_acyclic_frame(frame, now)) send(frame);
    deliver();
  }
  template <class Condition>
  void run_until(Condition condition, Duration limit = 3s) {
    const Time end = now + limit;
    while (!condition()) {
      ASSERT_LT(now, end) << "state " << static_cast<int>(feedback.state);
      step();
    }
  }
  void run_for(Duration duration) {
    for (const Time end = now + duration; now < end;) step();
  }
  void run_until_state(DriveState state) {
    run_until([&] { return feedback.state == state; });
  }
  void set_up() {
    node.boot();
    deliver();
    step();
    run_until_state(DriveState::disabled);
    ASSERT_EQ(drive.setup_status(), SetupStatus::ready);
    EXPECT_EQ(drive.setup_object(), ObjectAddress{});
  }
  void enable() {
    set_up();
    drive.request_enable();
    run_until_state(DriveState::enabled);
  }
};

}  // namespace breakaway::test
