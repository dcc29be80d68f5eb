// The power drive system's state machine (CiA 402-2): the states that the statusword 6041h shows, and the controlwords
// 6040h that ask for a transition.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace breakaway::cia402 {

enum class State : std::uint8_t {
  not_ready_to_switch_on,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

namespace status_bit {
inline constexpr std::uint16_t voltage_enabled = 1U << 4;
inline constexpr std::uint16_t quick_stop = 1U << 5;  // 0 while a quick stop is asked for
inline constexpr std::uint16_t warning = 1U << 7;
inline constexpr std::uint16_t remote = 1U << 9;
inline constexpr std::uint16_t target_reached = 1U << 10;
inline constexpr std::uint16_t internal_limit = 1U << 11;
inline constexpr std::uint16_t follows_target = 1U << 12;   // cyclic modes: the drive uses the target it is sent
inline constexpr std::uint16_t homing_attained = 1U << 12;  // homing mode: the drive counts from its home
inline constexpr std::uint16_t homing_error = 1U << 13;     // homing mode
}  // namespace status_bit

namespace control {
inline constexpr std::uint16_t disable_voltage = 0x00;
inline constexpr std::uint16_t quick_stop = 0x02;
inline constexpr std::uint16_t shutdown = 0x06;
inline constexpr std::uint16_t switch_on = 0x07;
inline constexpr std::uint16_t disable_operation = 0x07;
inline constexpr std::uint16_t enable_operation = 0x0F;
inline constexpr std::uint16_t start_homing = 0x10;  // homing mode: a bit beside enable operation
inline constexpr std::uint16_t fault_reset = 0x80;   // acts on the rising edge
inline constexpr std::uint16_t halt = 0x100;
}  // namespace control

// Returns the state that a statusword shows, or nothing for a combination that the profile does not define. Bits 0..3
// (0Fh), 5 (20h) and 6 (40h) tell the states apart; bit 5 does not count where the mask is 4Fh.
constexpr std::optional<State> state_of(std::uint16_t statusword) noexcept {
  switch (statusword & 0x4FU) {
    case 0x00:
      return State::not_ready_to_switch_on;
    case 0x40:
      return State::switch_on_disabled;
    case 0x0F:
      return State::fault_reaction_active;
    case 0x08:
      return State::fault;
    default:
      break;
  }
  switch (statusword & 0x6FU) {
    case 0x21:
      return State::ready_to_switch_on;
    case 0x23:
      return State::switched_on;
    case 0x27:
      return State::operation_enabled;
    case 0x07:
      return State::quick_stop_active;
    default:
      return std::nullopt;
  }
}

// Returns true in the states in which a drive moves its motor: by its target, or by its own way to a stop.
constexpr bool is_energised(State state) noexcept {
  return state == State::operation_enabled || state == State::quick_stop_active ||
         state == State::fault_reaction_active;
}

// Returns true in the states that prove a drive function switched off. One that is not ready is still starting up, or
// has nothing to say.
constexpr bool is_without_force(State state) noexcept {
  return !is_energised(state) && state != State::not_ready_to_switch_on;
}

// Returns true where the statusword shows a state in which the drive moves its motor.
constexpr bool shows_force(std::uint16_t statusword) noexcept {
  const std::optional<State> state = state_of(statusword);
  return state && is_energised(*state);
}

// Returns true where the statusword shows a state that proves the drive function switched off.
constexpr bool shows_no_force(std::uint16_t statusword) noexcept {
  const std::optional<State> state = state_of(statusword);
  return state && is_without_force(*state);
}

// Returns the bits by which a statusword shows the state, for a device that reports it.
constexpr std::uint16_t status_bits(State state) noexcept {
  switch (state) {
    case State::not_ready_to_switch_on:
      return 0x00;
    case State::switch_on_disabled:
      return 0x40;
    case State::ready_to_switch_on:
      return 0x21;
    case State::switched_on:
      return 0x23;
    case State::operation_enabled:
      return 0x27;
    case State::quick_stop_active:
      return 0x07;
    case State::fault_reaction_active:
      return 0x0F;
    case State::fault:
      return 0x08;
  }
  return 0x00;
}

constexpr std::string_view to_string(State state) noexcept {
  switch (state) {
    case State::not_ready_to_switch_on:
      return "Not ready to switch on";
    case State::switch_on_disabled:
      return "Switch on disabled";
    case State::ready_to_switch_on:
      return "Ready to switch on";
    case State::switched_on:
      return "Switched on";
    case State::operation_enabled:
      return "Operation enabled";
    case State::quick_stop_active:
      return "Quick stop active";
    case State::fault_reaction_active:
      return "Fault reaction active";
    case State::fault:
      return "Fault";
  }
  return "unknown state";
}

// Returns the state of a drive that is told to enable and does not, with what may keep it there. What else may: its
// RPDO is off, so that it hears nothing, or its TPDO, so that the state is that before.
constexpr std::string_view what_keeps_disabled(std::uint16_t statusword) noexcept {
  const std::optional<State> state = state_of(statusword);
  if (!state) return "no state of CiA 402";
  switch (*state) {
    case State::not_ready_to_switch_on:
      return "Not ready to switch on: its start-up is not over";
    case State::switch_on_disabled:
      return "Switch on disabled: STO, or no supply of the power stage?";
    case State::ready_to_switch_on:
      return "Ready to switch on: no supply of the power stage?";
    case State::switched_on:
      return "Switched on: a brake, or an interlock of the drive?";
    case State::operation_enabled:
    case State::quick_stop_active:
    case State::fault_reaction_active:
    case State::fault:
      break;
  }
  return to_string(*state);
}

}  // namespace breakaway::cia402
