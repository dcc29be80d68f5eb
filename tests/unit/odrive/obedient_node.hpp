// A drive, the simplest node at the far end of its wire, and the periods of the loop, for the tests of odrive::Drive.
// The node obeys at once, and says nothing by itself that a test does not want it to say.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "breakaway/odrive/drive.hpp"

namespace breakaway::odrive::test {

using namespace std::chrono_literals;

struct ObedientNode {
  std::uint8_t node_id = 5;
  AxisState state = AxisState::idle;
  std::uint32_t errors = 0, disarm_reason = 0;
  std::uint8_t result = 0, major = 0, minor = 6;
  float turns = 0, torque_Nm = 0;
  bool deaf = false;  // to every command
  bool deaf_to_idle = false;
  bool deaf_to_estop = false;
  bool enables = true;
  bool answers_version = true;
  bool silent = false;  // no heartbeats
  bool blind = false;   // no estimates
  bool mute = false;    // no torques
  hal::Duration heartbeat_period = 100ms;
  std::vector<hal::CanFrame> told;  // data frames
  float last_torque_Nm = 0;
  float limit_turns_s = 0, limit_A = 0;

  hal::CanFrame heartbeat() const {
    auto frame = frame_of(node_id, Command::heartbeat, errors, std::uint32_t{0});
    frame.data[4] = static_cast<std::uint8_t>(state);
    frame.data[5] = result;
    return frame;
  }
  hal::CanFrame version() const {
    auto frame = frame_of(node_id, Command::get_version, std::uint32_t{2}, std::uint32_t{0});
    frame.data[4] = major;
    frame.data[5] = minor;
    return frame;
  }
  hal::CanFrame estimates() const { return frame_of(node_id, Command::get_encoder_estimates, turns, 0.0F); }
  hal::CanFrame torques() const { return frame_of(node_id, Command::get_torques, last_torque_Nm, torque_Nm); }

  std::optional<hal::CanFrame> take(const hal::CanFrame& frame) {
    if (node_id_of(frame.id) != node_id) return {};
    const Command command = command_of(frame.id);
    if (frame.remote) return answer(command);
    told.push_back(frame);
    if (!deaf) obey(command, frame);
    return {};
  }

 private:
  std::optional<hal::CanFrame> answer(Command command) const {
    switch (command) {
      case Command::get_version:
        return answers_version ? std::optional{version()} : std::nullopt;
      case Command::heartbeat:
        return silent ? std::nullopt : std::optional{heartbeat()};
      case Command::get_error:
        return frame_of(node_id, Command::get_error, errors, disarm_reason);
      case Command::get_encoder_estimates:
        return blind ? std::nullopt : std::optional{estimates()};
      case Command::get_torques:
        return torques();
      default:
        return {};
    }
  }
  void obey(Command command, const hal::CanFrame& frame) {
    if (command == Command::set_input_torque) last_torque_Nm = load_float(frame, 0);
    if (command == Command::clear_errors) errors = disarm_reason = 0;
    if (command == Command::set_limits) limit_turns_s = load_float(frame, 0), limit_A = load_float(frame, 4);
    if (command == Command::estop && !deaf_to_estop) {
      state = AxisState::idle;
      errors |= error::estop_requested;
    }
    if (command != Command::set_axis_state) return;
    const auto asked = static_cast<AxisState>(load(frame, 0));
    if (asked == AxisState::idle && !deaf_to_idle) state = AxisState::idle;
    if (asked == AxisState::closed_loop_control && enables && errors == 0) state = asked;
  }
};

inline constexpr DriveConfig<float> config{
    .node_id = 5, .force_per_torque_N_per_Nm = 50, .max_torque_Nm = 1, .counts_per_turn = 1e5};
inline constexpr hal::NetworkConfig network{.period = 1ms};
inline constexpr hal::AxisScale<float> scale{.encoder_resolution_m = 1e-6F, .max_force_N = 40};
static_assert(check(config, network, scale) == DriveConfigError::none);

class DriveTest : public testing::Test {
 protected:
  explicit DriveTest(const DriveConfig<float>& c = config, const hal::AxisScale<float>& s = scale)
      : drive{c, network, s}, polled{c.estimates == Estimates::polled} {
    node.node_id = c.node_id;
  }

  void deliver(const hal::CanFrame& frame) { drive.on_frame({frame, now}); }

  // One period. The node answers and sends in it.
  void step(float force_N = 0) {
    now += 1ms;
    for (const auto& frame : answers) deliver(frame);
    answers.clear();
    if (!node.silent && now - last_heartbeat >= node.heartbeat_period) {
      last_heartbeat = now;
      deliver(node.heartbeat());
    }
    if (!polled && !node.blind) deliver(node.estimates());
    if (!polled && !node.blind && !node.mute) deliver(node.torques());
    drive.update(now);
    feedback = drive.feedback();
    if (feedback.state == hal::DriveState::enabled) drive.command(force_N);
    torque_Nm.reset();
    hal::CanFrame frame;
    if (drive.next_command_frame(frame)) {
      torque_Nm = load_float(frame, 0);
      send(frame);
    }
    while (drive.next_poll_frame(frame)) send(frame), ++questions;
    if (drive.next_acyclic_frame(frame, now)) send(frame);
  }
  void run(hal::Duration duration, float force_N = 0) {
    for (const hal::Time end = now + duration; now < end;) step(force_N);
  }
  void set_up() {
    run(300ms);
    ASSERT_EQ(feedback.state, hal::DriveState::disabled) << to_string(drive.setup_status());
  }
  void enable() {
    set_up();
    drive.request_enable();
    run(300ms);
    ASSERT_EQ(feedback.state, hal::DriveState::enabled);
  }
  int told(Command command) const {
    int count = 0;
    for (const auto& frame : node.told) count += command_of(frame.id) == command;
    return count;
  }

  Drive<float> drive;
  bool polled;
  ObedientNode node;
  hal::Time now{}, last_heartbeat{};
  hal::DriveFeedback<float> feedback{};
  std::optional<float> torque_Nm;  // of the newest command
  std::vector<hal::CanFrame> answers;
  int questions = 0;

 private:
  void send(const hal::CanFrame& frame) {
    if (const auto answer = node.take(frame)) answers.push_back(*answer);
  }
};

}  // namespace breakaway::odrive::test
