#include "breakaway/drive_emulator/state_machine.hpp"

#include <gtest/gtest.h>

#include <array>

namespace breakaway::drive_emulator {
namespace {

using State = cia402::State;

constexpr std::array all_states = {
    State::not_ready_to_switch_on, State::switch_on_disabled, State::ready_to_switch_on,    State::switched_on,
    State::operation_enabled,      State::quick_stop_active,  State::fault_reaction_active, State::fault};

// A machine in `state`, whose last controlword had bit 7 clear.
StateMachine machine_in(State state) {
  StateMachine machine;
  if (state == State::not_ready_to_switch_on) return machine;
  machine.self_test_passed();
  if (state == State::switch_on_disabled) return machine;
  machine.control(0x06, true, 6);
  if (state == State::ready_to_switch_on) return machine;
  machine.control(0x07, true, 6);
  if (state == State::switched_on) return machine;
  machine.control(0x0F, true, 6);
  if (state == State::operation_enabled) return machine;
  if (state == State::quick_stop_active) {
    machine.control(0x02, true, 6);
    return machine;
  }
  machine.trip();
  if (state == State::fault) machine.stop_finished(6);
  return machine;
}

// The controlword table of the profile: bits 7, 3, 2, 1, 0 that a command fixes, and the transitions that it makes.
struct TransitionRow {
  int number;
  std::uint16_t mask;
  std::uint16_t value;
  State from;
  State to;
};
constexpr TransitionRow transitions[] = {
    {2, 0x87, 0x06, State::switch_on_disabled, State::ready_to_switch_on},
    {3, 0x8F, 0x07, State::ready_to_switch_on, State::switched_on},
    {34, 0x8F, 0x0F, State::ready_to_switch_on, State::operation_enabled},
    {4, 0x8F, 0x0F, State::switched_on, State::operation_enabled},
    {5, 0x8F, 0x07, State::operation_enabled, State::switched_on},
    {6, 0x87, 0x06, State::switched_on, State::ready_to_switch_on},
    {7, 0x86, 0x02, State::ready_to_switch_on, State::switch_on_disabled},
    {7, 0x82, 0x00, State::ready_to_switch_on, State::switch_on_disabled},
    {8, 0x87, 0x06, State::operation_enabled, State::ready_to_switch_on},
    {9, 0x82, 0x00, State::operation_enabled, State::switch_on_disabled},
    {10, 0x86, 0x02, State::switched_on, State::switch_on_disabled},
    {10, 0x82, 0x00, State::switched_on, State::switch_on_disabled},
    {11, 0x86, 0x02, State::operation_enabled, State::quick_stop_active},
    {12, 0x82, 0x00, State::quick_stop_active, State::switch_on_disabled},
    {15, 0x80, 0x80, State::fault, State::switch_on_disabled},
    {16, 0x8F, 0x0F, State::quick_stop_active, State::operation_enabled},
};

TEST(DriveStateMachine, FollowsTheProfileForEveryControlwordInEveryState) {
  for (const State from : all_states) {
    ASSERT_EQ(machine_in(from).state(), from);
    for (unsigned word = 0; word <= 0xFFFF; ++word) {
      State expected = from;
      for (const TransitionRow& row : transitions)
        if (row.from == from && (word & row.mask) == row.value) expected = row.to;
      StateMachine machine = machine_in(from);
      machine.control(static_cast<std::uint16_t>(word), true, 6);
      ASSERT_EQ(machine.state(), expected) << cia402::to_string(from) << ", controlword " << word;
    }
  }
}

TEST(DriveStateMachine, TripsFromEveryStateAndEndsInFault) {
  for (const State from : all_states) {
    StateMachine machine = machine_in(from);
    machine.trip();
    EXPECT_EQ(machine.state(), from == State::fault ? State::fault : State::fault_reaction_active);
    machine.stop_finished(2);
    EXPECT_EQ(machine.state(), State::fault);
  }
}

TEST(DriveStateMachine, ResetsAFaultOnTheRisingEdgeOnly) {
  StateMachine machine = machine_in(State::fault);
  machine.control(0x80, false, 2);  // the cause is still there
  EXPECT_EQ(machine.state(), State::fault);
  machine.control(0x80, true, 2);  // gone, but no edge
  EXPECT_EQ(machine.state(), State::fault);
  machine.control(0x00, true, 2);
  machine.control(0x80, true, 2);
  EXPECT_EQ(machine.state(), State::switch_on_disabled);
}

TEST(DriveStateMachine, LeavesQuickStopByItselfWhereTheOptionCodeSaysSo) {
  for (const int option : {1, 2, 3, 4, 5, 6, 7, 8}) {
    StateMachine machine = machine_in(State::operation_enabled);
    machine.control(0x02, true, option);
    EXPECT_EQ(machine.state(), State::quick_stop_active);
    machine.stop_finished(option);
    EXPECT_EQ(machine.state(), option < 5 ? State::switch_on_disabled : State::quick_stop_active) << option;
  }
}

TEST(DriveStateMachine, ReturnsFromQuickStopOnlyWhereTheOptionCodeStays) {
  for (const int option : {1, 2, 3, 4, 5, 6, 7, 8}) {
    StateMachine machine = machine_in(State::quick_stop_active);
    machine.control(0x0F, true, option);
    EXPECT_EQ(machine.state(), option < 5 ? State::quick_stop_active : State::operation_enabled) << option;
  }
}

TEST(DriveStateMachine, QuickStopOptionZeroDisablesAtOnce) {
  StateMachine machine = machine_in(State::operation_enabled);
  machine.control(0x02, true, 0);
  EXPECT_EQ(machine.state(), State::switch_on_disabled);
}

}  // namespace
}  // namespace breakaway::drive_emulator
