// The messages of CANSimple, ODrive's protocol on classic CAN, as firmware 0.6 speaks it.
//
// An identifier is the node's id (six bits) and a command (five bits). A data frame of the master commands; a remote
// frame of the master asks, and the drive answers with a data frame of the same identifier, which it may also send by
// itself in whole milliseconds. Numbers are little-endian, and physical quantities are IEEE 754 floats in turns, turns
// a second, newton metres and amperes. There is no SYNC, no acknowledgement, and no way to read back a mode or a limit.
//
// What firmware 0.5 does otherwise: it has no Get_Version (0x00 is NMT there), byte 5 of its heartbeat is a flag and no
// procedure result, 0x03 is the motor's error of 64 bits, 0x1C and 0x1D are absent or mean something else, and its
// error bits are others. So a drive that does not answer Get_Version with 0.6 or later is not used.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "breakaway/hal/can_frame.hpp"

namespace breakaway::odrive {

// The id 63 is that of drives which have none yet.
inline constexpr std::uint8_t most_node_id = 62;
inline constexpr unsigned command_bits = 5;

enum class Command : std::uint8_t {
  get_version = 0x00,
  heartbeat = 0x01,
  estop = 0x02,
  get_error = 0x03,
  write_parameter = 0x04,
  set_axis_state = 0x07,
  get_encoder_estimates = 0x09,
  set_controller_mode = 0x0B,
  set_input_position = 0x0C,
  set_input_velocity = 0x0D,
  set_input_torque = 0x0E,
  set_limits = 0x0F,
  set_trajectory_inertia = 0x13,
  reboot = 0x16,
  clear_errors = 0x18,
  set_velocity_gains = 0x1B,
  get_torques = 0x1C,
};

enum class AxisState : std::uint8_t {
  undefined = 0,
  idle = 1,
  startup_sequence = 2,
  closed_loop_control = 8,
};

// The power stage is off in these two only; every other state may give torque.
constexpr bool is_without_torque(AxisState state) noexcept {
  return state == AxisState::undefined || state == AxisState::idle;
}

enum class ControlMode : std::uint32_t { torque = 1 };
enum class InputMode : std::uint32_t { passthrough = 1 };

constexpr std::uint16_t identifier(std::uint8_t node_id, Command command) noexcept {
  return static_cast<std::uint16_t>(unsigned{node_id} << command_bits | static_cast<unsigned>(command));
}
constexpr std::uint8_t node_id_of(std::uint16_t identifier) noexcept {
  return static_cast<std::uint8_t>(identifier >> command_bits);
}
constexpr Command command_of(std::uint16_t identifier) noexcept {
  return static_cast<Command>(identifier & ((1U << command_bits) - 1));
}

constexpr void store(hal::CanFrame& frame, std::uint32_t value, std::size_t offset) noexcept {
  for (std::size_t i = 0; i < 4; ++i) frame.data[offset + i] = static_cast<std::uint8_t>(value >> (8 * i));
}
constexpr std::uint32_t load(const hal::CanFrame& frame, std::size_t offset) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{frame.data[offset + i]} << (8 * i);
  return value;
}
constexpr void store(hal::CanFrame& frame, float value, std::size_t offset) noexcept {
  store(frame, std::bit_cast<std::uint32_t>(value), offset);
}
constexpr float load_float(const hal::CanFrame& frame, std::size_t offset) noexcept {
  return std::bit_cast<float>(load(frame, offset));
}

// Asks for a message.
constexpr hal::CanFrame request_frame(std::uint8_t node_id, Command command) noexcept {
  return {.id = identifier(node_id, command), .size = 8, .remote = true, .data = {}};
}

// A command with up to two values, which are uint32 or float.
template <class First, class Second>
constexpr hal::CanFrame frame_of(std::uint8_t node_id, Command command, First first, Second second) noexcept {
  hal::CanFrame frame{.id = identifier(node_id, command), .size = 8, .remote = false, .data = {}};
  store(frame, first, 0);
  store(frame, second, 4);
  return frame;
}

constexpr hal::CanFrame axis_state_frame(std::uint8_t node_id, AxisState state) noexcept {
  return frame_of(node_id, Command::set_axis_state, static_cast<std::uint32_t>(state), std::uint32_t{0});
}
// The axis follows Set_Input_Torque as it comes.
constexpr hal::CanFrame torque_mode_frame(std::uint8_t node_id) noexcept {
  return frame_of(node_id, Command::set_controller_mode, static_cast<std::uint32_t>(ControlMode::torque),
                  static_cast<std::uint32_t>(InputMode::passthrough));
}
constexpr hal::CanFrame torque_frame(std::uint8_t node_id, float torque_Nm) noexcept {
  return frame_of(node_id, Command::set_input_torque, torque_Nm, std::uint32_t{0});
}
constexpr hal::CanFrame limits_frame(std::uint8_t node_id, float velocity_turns_s, float current_A) noexcept {
  return frame_of(node_id, Command::set_limits, velocity_turns_s, current_A);
}
constexpr hal::CanFrame estop_frame(std::uint8_t node_id) noexcept {
  return {.id = identifier(node_id, Command::estop), .size = 0, .remote = false, .data = {}};
}
constexpr hal::CanFrame clear_errors_frame(std::uint8_t node_id) noexcept {
  return {.id = identifier(node_id, Command::clear_errors), .size = 1, .remote = false, .data = {}};
}

struct Heartbeat {
  std::uint32_t errors = 0;  // active errors, and the reason of the last disarming
  AxisState state = AxisState::undefined;
  std::uint8_t procedure_result = 0;
};
struct Version {
  std::uint8_t major = 0, minor = 0;  // of the firmware
};
struct Errors {
  std::uint32_t active = 0, disarm_reason = 0;
};
// What Get_Encoder_Estimates and Get_Torques carry.
struct FloatPair {
  float first = 0, second = 0;
};

namespace internal {

constexpr bool is(const hal::CanFrame& frame, Command command) noexcept {
  return command_of(frame.id) == command && !frame.remote && frame.size == 8;
}

}  // namespace internal

// These return what the frame says, and nothing where it is another message or too short.
constexpr std::optional<Heartbeat> as_heartbeat(const hal::CanFrame& frame) noexcept {
  if (!internal::is(frame, Command::heartbeat)) return {};
  return Heartbeat{load(frame, 0), static_cast<AxisState>(frame.data[4]), frame.data[5]};
}
constexpr std::optional<Version> as_version(const hal::CanFrame& frame) noexcept {
  if (!internal::is(frame, Command::get_version)) return {};
  return Version{frame.data[4], frame.data[5]};
}
constexpr std::optional<Errors> as_errors(const hal::CanFrame& frame) noexcept {
  if (!internal::is(frame, Command::get_error)) return {};
  return Errors{load(frame, 0), load(frame, 4)};
}
constexpr std::optional<FloatPair> as_estimates(const hal::CanFrame& frame) noexcept {
  if (!internal::is(frame, Command::get_encoder_estimates)) return {};
  return FloatPair{load_float(frame, 0), load_float(frame, 4)};
}
constexpr std::optional<FloatPair> as_torques(const hal::CanFrame& frame) noexcept {
  if (!internal::is(frame, Command::get_torques)) return {};
  return FloatPair{load_float(frame, 0), load_float(frame, 4)};
}

}  // namespace breakaway::odrive
