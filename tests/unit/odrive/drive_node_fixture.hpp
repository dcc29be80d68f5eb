// A drive's node by itself, its frames and a clock of nanoseconds, for the tests of odrive::DriveNode.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "breakaway/odrive/drive_node.hpp"

namespace breakaway::odrive::test {

using namespace std::chrono_literals;

inline constexpr std::uint8_t asked_node = 5;
inline constexpr NodeSettings usual{
    .node_id = asked_node, .period = 1ms, .heartbeat_period = 100ms, .heartbeat_timeout = 250ms};

class NodeTest : public testing::Test {
 protected:
  void heartbeat(AxisState state, std::uint32_t errors = 0, std::uint8_t result = 0) {
    auto frame = frame_of(asked_node, Command::heartbeat, errors, std::uint32_t{0});
    frame.data[4] = static_cast<std::uint8_t>(state);
    frame.data[5] = result;
    node.on_frame({frame, now});
  }
  void version(std::uint8_t major, std::uint8_t minor) {
    hal::CanFrame frame{.id = identifier(asked_node, Command::get_version), .size = 8};
    frame.data[4] = major;
    frame.data[5] = minor;
    node.on_frame({frame, now});
  }
  void errors(std::uint32_t active, std::uint32_t disarm_reason) {
    node.on_frame({frame_of(asked_node, Command::get_error, active, disarm_reason), now});
  }
  void update_after(hal::Duration time) {
    now += time;
    node.update(now);
  }
  // The next frame that is to be sent, with everything of it; nothing: none is.
  std::optional<hal::CanFrame> next() {
    hal::CanFrame frame;
    return node.next_frame(frame, now) ? std::optional{frame} : std::nullopt;
  }
  void make_ready(const NodeSettings& settings = usual) {
    node = DriveNode{settings};
    heartbeat(AxisState::idle);
    update_after(1ms);
    ASSERT_EQ(next(), request_frame(asked_node, Command::get_version));
    version(0, 6);
    ASSERT_EQ(next(), torque_mode_frame(asked_node));
    node.on_estimate(now);
    update_after(1ms);
    ASSERT_TRUE(node.ready());
  }
  void make_follow(const NodeSettings& settings = usual) {
    make_ready(settings);
    node.request_enable();
    ASSERT_EQ(next(), mode);
    ASSERT_EQ(next(), enable);
    heartbeat(AxisState::closed_loop_control);
    update_after(1ms);
    ASSERT_TRUE(node.follows());
  }

  const hal::CanFrame idle = axis_state_frame(asked_node, AxisState::idle), estop = estop_frame(asked_node),
                      mode = torque_mode_frame(asked_node),
                      enable = axis_state_frame(asked_node, AxisState::closed_loop_control),
                      ask_errors = request_frame(asked_node, Command::get_error),
                      ask_heartbeat = request_frame(asked_node, Command::heartbeat);
  DriveNode node{usual};
  hal::Time now{10s};
};

}  // namespace breakaway::odrive::test
