// What the two PDOs of a drive say to somebody who only listens, in the units of the drive and the direction of the
// axis.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "breakaway/canopen/pdo.hpp"
#include "breakaway/cia402/pdo_layout.hpp"
#include "breakaway/cia402/state.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/motor_drive.hpp"

namespace breakaway::cia402 {

struct OverheardFeedback {
  hal::DriveState state = hal::DriveState::configuring;
  std::int32_t position_counts = 0;
  std::int16_t torque_per_mille = 0;
};

// The state as hal::DriveState has it. A drive on its way to Operation enabled shows as disabled.
constexpr hal::DriveState overheard_state(State state) noexcept {
  switch (state) {
    case State::operation_enabled:
      return hal::DriveState::enabled;
    case State::quick_stop_active:
    case State::fault_reaction_active:
      return hal::DriveState::stopping;
    case State::fault:
      return hal::DriveState::fault;
    case State::not_ready_to_switch_on:
    case State::switch_on_disabled:
    case State::ready_to_switch_on:
    case State::switched_on:
      break;
  }
  return hal::DriveState::disabled;
}

namespace internal {

// A torque turned to the direction of the axis; the least number has no other sign.
constexpr std::int16_t turned(std::uint64_t bits, bool invert) noexcept {
  const auto torque = static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
  return static_cast<std::int16_t>(invert && torque != INT16_MIN ? -torque : torque);
}

}  // namespace internal

// Returns what the drive with this node id tells of itself, if the frame is that.
constexpr std::optional<OverheardFeedback> overheard_feedback(const hal::CanFrame& frame, std::uint8_t node_id,
                                                              bool invert_direction) noexcept {
  std::array<std::uint64_t, 3> values{};
  if (!canopen::unpack_pdo(feedback_pdo(node_id), frame, values)) return {};
  OverheardFeedback heard;
  if (const auto state = state_of(static_cast<std::uint16_t>(values[0]))) heard.state = overheard_state(*state);
  const auto counts = static_cast<std::uint32_t>(values[1]);
  heard.position_counts = static_cast<std::int32_t>(invert_direction ? 0U - counts : counts);
  heard.torque_per_mille = internal::turned(values[2], invert_direction);
  return heard;
}

// Returns the torque [per mille] that the drive with this node id is told to give, if the frame is that.
constexpr std::optional<std::int16_t> overheard_command(const hal::CanFrame& frame, std::uint8_t node_id,
                                                        bool invert_direction) noexcept {
  std::array<std::uint64_t, 2> values{};
  if (!canopen::unpack_pdo(command_pdo(node_id), frame, values)) return {};
  return internal::turned(values[1], invert_direction);
}

}  // namespace breakaway::cia402
