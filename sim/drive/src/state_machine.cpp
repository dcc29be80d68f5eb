#include "breakaway/drive_emulator/state_machine.hpp"

namespace breakaway::drive_emulator {

using cia402::State;

namespace {

constexpr std::uint16_t fault_reset_bit = 0x80;

// The value 0 of 605Ah removes the torque at once, 1 to 4 stop and leave by themselves, 5 to 8 stop and stay.
bool leaves_quick_stop(std::int64_t option) { return option < 5; }

}  // namespace

Command decode(std::uint16_t controlword) {
  if ((controlword & fault_reset_bit) != 0) return Command::none;
  if ((controlword & 0x02) == 0) return Command::disable_voltage;
  if ((controlword & 0x04) == 0) return Command::quick_stop;
  if ((controlword & 0x01) == 0) return Command::shutdown;
  return (controlword & 0x08) == 0 ? Command::switch_on : Command::enable_operation;
}

void StateMachine::self_test_passed() {
  if (state_ == State::not_ready_to_switch_on) state_ = State::switch_on_disabled;
}

void StateMachine::control(std::uint16_t controlword, bool may_reset, std::int64_t quick_stop_option) {
  const bool reset_edge = (controlword & fault_reset_bit) != 0 && (last_controlword_ & fault_reset_bit) == 0;
  last_controlword_ = controlword;
  if (state_ == State::fault && reset_edge && may_reset) state_ = State::switch_on_disabled;  // 15
  apply(decode(controlword), quick_stop_option);
}

void StateMachine::apply(Command command, std::int64_t quick_stop_option) {
  switch (state_) {
    case State::not_ready_to_switch_on:
    case State::fault_reaction_active:
    case State::fault:
      return;
    case State::switch_on_disabled:
      if (command == Command::shutdown) state_ = State::ready_to_switch_on;  // 2
      return;
    case State::ready_to_switch_on:
      if (command == Command::disable_voltage || command == Command::quick_stop)
        state_ = State::switch_on_disabled;                                         // 7
      if (command == Command::switch_on) state_ = State::switched_on;               // 3
      if (command == Command::enable_operation) state_ = State::operation_enabled;  // 3 and 4
      return;
    case State::switched_on:
      if (command == Command::disable_voltage || command == Command::quick_stop)
        state_ = State::switch_on_disabled;                                         // 10
      if (command == Command::shutdown) state_ = State::ready_to_switch_on;         // 6
      if (command == Command::enable_operation) state_ = State::operation_enabled;  // 4
      return;
    case State::operation_enabled:
      if (command == Command::disable_voltage) state_ = State::switch_on_disabled;  // 9
      if (command == Command::shutdown) state_ = State::ready_to_switch_on;         // 8
      if (command == Command::switch_on) state_ = State::switched_on;               // 5
      if (command == Command::quick_stop)                                           // 11
        state_ = quick_stop_option == 0 ? State::switch_on_disabled : State::quick_stop_active;
      return;
    case State::quick_stop_active:
      if (command == Command::disable_voltage) state_ = State::switch_on_disabled;  // 12
      if (command == Command::enable_operation && !leaves_quick_stop(quick_stop_option))
        state_ = State::operation_enabled;  // 16
      return;
  }
}

void StateMachine::trip() {
  if (state_ != State::fault) state_ = State::fault_reaction_active;
}

void StateMachine::stop_finished(std::int64_t quick_stop_option) {
  if (state_ == State::fault_reaction_active) state_ = State::fault;
  if (state_ == State::quick_stop_active && leaves_quick_stop(quick_stop_option)) state_ = State::switch_on_disabled;
}

void StateMachine::disable_voltage() { apply(Command::disable_voltage, 0); }

void StateMachine::fall_back_to(State highest) {
  if (state_ > highest && state_ <= State::quick_stop_active) state_ = highest;
}

}  // namespace breakaway::drive_emulator
