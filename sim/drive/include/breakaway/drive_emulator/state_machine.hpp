// StateMachine: the power drive system's states as the drive runs them (CiA 402-2, figure "PDS FSA", transitions 0 to
// 16).
#pragma once

#include <cstdint>

#include "breakaway/cia402/state.hpp"

namespace breakaway::drive_emulator {

// Command: what a controlword asks for by its bits 7, 3, 2, 1 and 0.
enum class Command : std::uint8_t {
  none,              // bit 7 is set, of which only the rising edge means something
  disable_voltage,   // 0xx0x
  quick_stop,        // 0x01x
  shutdown,          // 0x110
  switch_on,         // 00111, the same word as `disable operation`
  enable_operation,  // 01111
};

Command decode(std::uint16_t controlword);

class StateMachine {
 public:
  using State = cia402::State;

  State state() const { return state_; }
  void power_up() { state_ = State::not_ready_to_switch_on; }
  void self_test_passed();  // transitions 0 and 1

  // Takes one controlword. may_reset: no cause of a fault is present. quick_stop_option: 605Ah.
  void control(std::uint16_t controlword, bool may_reset, std::int64_t quick_stop_option);

  void trip();                                         // transition 13, from any state but the fault states
  void stop_finished(std::int64_t quick_stop_option);  // transition 14, or 12 where 605Ah says so
  void disable_voltage();                              // transitions 7, 9, 10, 12, as by controlword
  // To a state without force, unasked, from one beyond it that is no fault.
  void fall_back_to(State highest);

 private:
  void apply(Command command, std::int64_t quick_stop_option);

  State state_ = State::not_ready_to_switch_on;
  std::uint16_t last_controlword_ = 0;
};

}  // namespace breakaway::drive_emulator
