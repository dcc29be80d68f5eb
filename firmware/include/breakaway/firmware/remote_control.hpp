// Another node on the bus commands a controller node, and is told about it, by the controller's own first PDOs.
//
//   command, RPDO1 of the node, 8 bytes: axis | bit 0 enable, 1 reset fault, 2 reference | 0 | 0 | target, int32 counts
//   status,  TPDO1 of the node, 8 bytes: axis | AxisFault | Mode | DriveState  | position in counts, int32
//
// Numbers are little-endian, and the axes of a node count from 0. A target and "not enabled" act as long as they are
// said. "Enable" acts on its rising edge, and so do the reset and the reference, which go on until they are taken while
// they are said: a controller that was restarted energises nothing because somebody still repeats an old command. The
// reference says that the axis stands at the target now, by definition.
//
// A commander says its commands again before LoopConfig::command_timeout is over. An axis whose commander falls silent
// for longer stops with the fault "commander lost", and needs a reset and a new edge.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::firmware {

struct MotionCommand {
  std::uint8_t axis = 0;
  bool enable = false;
  bool reset_fault = false;
  bool reference = false;  // the axis stands at the target
  std::int32_t target_counts = 0;
  bool stopped = false;  // "not enabled" was said before it, in the same period
};

inline std::optional<MotionCommand> decode_command(const hal::CanFrame& frame, std::uint8_t node_id) noexcept {
  if (frame.id != canopen::rpdo_cob_id(1, node_id) || frame.remote || frame.size != 8) return {};
  const auto target = canopen::load_little_endian<std::int32_t>(frame.payload(), 4);
  return MotionCommand{.axis = frame.data[0],
                       .enable = (frame.data[1] & 1U) != 0,
                       .reset_fault = (frame.data[1] & 2U) != 0,
                       .reference = (frame.data[1] & 4U) != 0,
                       .target_counts = target};
}

inline hal::CanFrame encode_command(const MotionCommand& command, std::uint8_t node_id) noexcept {
  hal::CanFrame frame{.id = canopen::rpdo_cob_id(1, node_id), .size = 8};
  frame.data[0] = command.axis;
  frame.data[1] = static_cast<std::uint8_t>((command.enable ? 1U : 0U) | (command.reset_fault ? 2U : 0U) |
                                            (command.reference ? 4U : 0U));
  canopen::store_little_endian(frame.data, command.target_counts, 4);
  return frame;
}

// A CanPort that takes the commands for this node out of what another port receives. The newest command for an axis
// counts, but none hides a stop.
template <hal::CanPort Port, std::size_t MaxAxes>
class CommandedPort {
 public:
  CommandedPort(Port& port, std::uint8_t node_id) noexcept : port_{&port}, node_id_{node_id} {}

  hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept { return port_->send(frame, deadline); }
  bool receive(hal::ReceivedFrame& received) noexcept {
    while (port_->receive(received)) {
      const auto command = decode_command(received.frame, node_id_);
      if (!command) return true;
      if (command->axis < MaxAxes) take(*command);
    }
    return false;
  }
  void purge_transmit_queue() noexcept { port_->purge_transmit_queue(); }
  hal::BusState bus_state() const noexcept { return port_->bus_state(); }

  // Returns the newest command, if one came since the last call. `axis` must be below MaxAxes.
  std::optional<MotionCommand> take_command(std::size_t axis) noexcept {
    if (!commands_[axis]) return {};
    return std::exchange(commands_[axis], std::nullopt);
  }

 private:
  void take(const MotionCommand& command) noexcept {
    std::optional<MotionCommand>& newest = commands_[command.axis];
    const bool stopped = newest && (newest->stopped || !newest->enable);
    newest = command;
    newest->stopped = stopped;
  }

  Port* port_;
  std::uint8_t node_id_;
  std::array<std::optional<MotionCommand>, MaxAxes> commands_{};
};

// Carries the commands for one axis out on a ControlLoop.
class RemoteAxis {
 public:
  // Cold: a commander speaks once in many periods, and where memory for code is short the step shall have it.
  template <class Loop>
  [[gnu::cold]] void apply(Loop& loop, typename Loop::AxisId axis, const MotionCommand& command,
                           hal::Time now) noexcept {
    const bool stops = command.stopped || !command.enable;
    const bool enables = command.enable && (command.stopped || (last_ && !last_->enable));
    // A target that somebody wrote while the axis was enabled does not outlast that.
    const bool new_target = !last_ || command.target_counts != last_->target_counts ||
                            (enables && command.target_counts != loop.target_counts(axis));
    if (new_target) loop.set_target_counts(axis, command.target_counts);
    const bool resets = last_ && command.reset_fault && !last_->reset_fault;
    const bool refused = resets && !loop.reset_fault(axis);
    const bool refers = last_ && command.reference && !last_->reference;
    const bool not_taken = refers && !loop.set_reference_counts(axis, command.target_counts);
    if (stops) loop.request_stop(axis);
    if (enables) loop.request_enable(axis);
    last_ = command;
    last_->reset_fault = command.reset_fault && !refused;
    last_->reference = command.reference && !not_taken;
    heard_at_ = now;
  }

  // Once a period: stops the axis by name when nothing was heard for longer than `timeout`.
  template <class Loop>
  void watch(Loop& loop, typename Loop::AxisId axis, hal::Time now, hal::Duration timeout) noexcept {
    if (!last_ || now - heard_at_ <= timeout) return;
    loop.stop_with(axis, AxisFault::commander_lost, now);
    last_.reset();
  }

 private:
  std::optional<MotionCommand> last_;  // nothing: none came since the start, or since the deadline passed
  hal::Time heard_at_{};
};

// Returns the frame that tells of an axis.
template <class Loop>
hal::CanFrame status_frame(const Loop& loop, typename Loop::AxisId axis, std::uint8_t node_id) noexcept {
  const auto& status = loop.status(axis);
  hal::CanFrame frame{.id = canopen::tpdo_cob_id(1, node_id), .size = 8};
  frame.data = {static_cast<std::uint8_t>(axis.index()), static_cast<std::uint8_t>(status.fault),
                static_cast<std::uint8_t>(status.output.mode), static_cast<std::uint8_t>(status.feedback.state)};
  canopen::store_little_endian(frame.data, loop.drive(axis).position_counts(), 4);
  return frame;
}

// What such a frame says: numbers of the enumerations, which an image of another version may count differently.
struct MotionStatus {
  std::uint8_t axis = 0;
  std::uint8_t fault = 0;        // AxisFault
  std::uint8_t mode = 0;         // law::Mode
  std::uint8_t drive_state = 0;  // hal::DriveState
  std::int32_t position_counts = 0;
};

// Returns what the node with this id tells of an axis, if the frame is that.
inline std::optional<MotionStatus> decode_status(const hal::CanFrame& frame, std::uint8_t node_id) noexcept {
  if (frame.id != canopen::tpdo_cob_id(1, node_id) || frame.remote || frame.size != 8) return {};
  const auto position = canopen::load_little_endian<std::int32_t>(frame.payload(), 4);
  return MotionStatus{frame.data[0], frame.data[1], frame.data[2], frame.data[3], position};
}

}  // namespace breakaway::firmware
