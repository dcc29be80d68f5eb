#include "breakaway/cia402/state_machine.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using namespace std::chrono_literals;
using namespace breakaway::cia402;
using breakaway::hal::Time;

class StateMachineTest : public testing::Test {
 protected:
  StateMachine machine;
  Time now{};

  std::uint16_t see(State state) {
    machine.on_statusword(status_bits(state));
    return step();
  }
  std::uint16_t step() {
    now += 1ms;
    machine.update(now);
    return machine.controlword();
  }
  void walk_to_operation() {
    machine.request_enable();
    for (const State state :
         {State::switch_on_disabled, State::ready_to_switch_on, State::switched_on, State::operation_enabled})
      see(state);
    ASSERT_TRUE(machine.follows());
  }
};

TEST_F(StateMachineTest, SendsTheControlwordOfEachState) {
  struct Row {
    State state;
    unsigned with_wish, without_wish;
  };
  const Row rows[] = {{State::not_ready_to_switch_on, 0x00, 0x00}, {State::switch_on_disabled, 0x06, 0x00},
                      {State::ready_to_switch_on, 0x07, 0x00},     {State::switched_on, 0x0F, 0x00},
                      {State::operation_enabled, 0x0F, 0x02},      {State::quick_stop_active, 0x00, 0x02},
                      {State::fault_reaction_active, 0x00, 0x00},  {State::fault, 0x00, 0x00}};
  for (const Row& row : rows) {
    machine.restart();
    machine.request_enable();
    EXPECT_EQ(see(row.state), row.with_wish) << to_string(row.state);
    machine.restart();
    EXPECT_EQ(see(row.state), row.without_wish) << to_string(row.state);
  }
}

TEST_F(StateMachineTest, BeforeTheFirstStatuswordNoVoltage) {
  EXPECT_EQ(machine.controlword(), 0x00) << "before the first period, too";
  machine.request_enable();
  EXPECT_EQ(step(), 0x00);
  machine.on_statusword(0x0002);  // a combination that the profile does not define
  EXPECT_EQ(step(), 0x00);
  EXPECT_FALSE(machine.state().has_value());
  EXPECT_FALSE(machine.without_force()) << "nobody said so";
}

TEST_F(StateMachineTest, FollowsOnlyInOperationEnabled) {
  walk_to_operation();
  machine.request_stop();
  EXPECT_FALSE(machine.follows());
}

TEST_F(StateMachineTest, DriveThatLeavesOperationByItselfStaysOff) {
  for (const State dropped_to : {State::switched_on, State::ready_to_switch_on, State::switch_on_disabled,
                                 State::quick_stop_active, State::fault_reaction_active, State::fault}) {
    machine.restart();
    walk_to_operation();
    see(dropped_to);
    EXPECT_FALSE(machine.enable_wished()) << to_string(dropped_to);
    for (const State state : {State::switch_on_disabled, State::ready_to_switch_on, State::switched_on})
      EXPECT_EQ(see(state), 0x00) << to_string(dropped_to);
  }
}

TEST_F(StateMachineTest, QuickStopThatLeavesByItselfIsFollowed) {
  walk_to_operation();
  machine.request_stop();
  EXPECT_EQ(see(State::operation_enabled), 0x02);
  EXPECT_EQ(see(State::quick_stop_active), 0x02);
  EXPECT_EQ(see(State::switch_on_disabled), 0x00);
  machine.request_enable();
  EXPECT_EQ(step(), 0x06);
}

TEST_F(StateMachineTest, QuickStopThatStaysIsSwitchedOffAfterASecond) {
  walk_to_operation();
  machine.request_stop();
  see(State::quick_stop_active);
  const Time begin = now;
  while (step() == 0x02) ASSERT_LT(now - begin, 2s);
  EXPECT_EQ(machine.controlword(), 0x00);
  EXPECT_EQ(now - begin, StateMachine::quick_stop_time + 1ms);
}

TEST_F(StateMachineTest, FaultResetShowsTheBitLowThenHighThenLow) {
  see(State::fault);
  EXPECT_EQ(step(), 0x00) << "a fault is latched until it is acknowledged";
  machine.reset_fault();
  std::string edges;
  for (int i = 0; i < 20; ++i) edges += step() == 0x80 ? 'H' : 'L';
  EXPECT_EQ(edges, "LLLHHHLLLLLLLLLLLLLL");
}

// One of them may be lost.
TEST_F(StateMachineTest, FaultResetLevelsAreShownInThreeControlwordsHoweverLongThePeriod) {
  see(State::fault);
  machine.reset_fault();
  std::string edges;
  for (int i = 0; i < 9; ++i) {
    now += 19ms;
    edges += step() == 0x80 ? 'H' : 'L';
  }
  EXPECT_EQ(edges, "LLLHHHLLL");
}

TEST_F(StateMachineTest, AResetOfALongPeriodThatTheFaultsEndCutShortIsAWholeOneTheNextTime) {
  for (int steps = 1; steps < 7; ++steps) {
    see(State::fault);
    machine.reset_fault();
    for (int i = 0; i < steps; ++i, now += 19ms) step();
    see(State::switch_on_disabled);
    see(State::fault);
    machine.reset_fault();
    std::string edges;
    for (int i = 0; i < 8; ++i, now += 19ms) edges += step() == 0x80 ? 'H' : 'L';
    EXPECT_EQ(edges, "LLLHHHLL") << steps;
    see(State::switch_on_disabled);
  }
}

TEST_F(StateMachineTest, FaultResetLevelsLastForTheirTimeHoweverShortThePeriod) {
  see(State::fault);
  machine.reset_fault();
  std::string edges;
  for (int i = 0; i < 100; ++i) {
    now -= 900us;  // of the millisecond that a step takes
    edges += step() == 0x80 ? 'H' : 'L';
  }
  EXPECT_EQ(edges, std::string(30, 'L') + std::string(30, 'H') + std::string(40, 'L'));
}

TEST_F(StateMachineTest, FaultResetEndsWithTheFaultAndCanBeAskedAgain) {
  see(State::fault);
  machine.reset_fault();
  while (step() != 0x80) ASSERT_LT(now, Time{1s});
  EXPECT_EQ(see(State::switch_on_disabled), 0x00);
  see(State::fault);
  EXPECT_EQ(step(), 0x00);
  machine.reset_fault();
  while (step() != 0x80) ASSERT_LT(now, Time{1s});
}

// The bit has to be low before it rises, also where an earlier reset left off.
TEST_F(StateMachineTest, EveryFaultResetShowsTheWholeOfItsLevels) {
  for (int reset = 0; reset < 3; ++reset) {
    see(State::fault);
    machine.reset_fault();
    for (const unsigned expected : {0x00U, 0x00U, 0x00U, 0x80U, 0x80U, 0x80U, 0x00U, 0x00U})
      EXPECT_EQ(step(), expected);
    see(State::switch_on_disabled);
  }
}

TEST_F(StateMachineTest, AskingAgainDoesNotProlongAFaultReset) {
  see(State::fault);
  std::string edges;
  for (int i = 0; i < 6; ++i) {
    machine.reset_fault();
    edges += step() == 0x80 ? 'H' : 'L';
  }
  EXPECT_EQ(edges, "LLLHHH");
}

TEST_F(StateMachineTest, AResetThatIsUnderWayDoesNotClearTheNextFault) {
  for (int steps = 1; steps < 6; ++steps) {
    machine.restart();
    see(State::fault);
    machine.reset_fault();
    for (int i = 0; i < steps; ++i) step();
    EXPECT_EQ(see(State::switch_on_disabled), 0x00);
    EXPECT_EQ(see(State::fault), 0x00);
    for (int i = 0; i < 20; ++i) EXPECT_EQ(step(), 0x00) << "reset for " << steps << " ms";
  }
}

TEST_F(StateMachineTest, AFaultOnTheWayUpTakesTheWishBack) {
  for (const State failed : {State::fault_reaction_active, State::fault}) {
    machine.restart();
    machine.request_enable();
    see(State::switch_on_disabled);
    EXPECT_EQ(see(State::ready_to_switch_on), 0x07);
    EXPECT_EQ(see(failed), 0x00);
    EXPECT_FALSE(machine.enable_wished()) << to_string(failed);
    for (const State state : {State::switch_on_disabled, State::ready_to_switch_on, State::switched_on})
      EXPECT_EQ(see(state), 0x00) << to_string(failed);
  }
}

TEST_F(StateMachineTest, EverySecondQuickStopLastsAsLongAsTheFirst) {
  for (int stop = 0; stop < 2; ++stop) {
    machine.restart();
    for (int again = 0; again < 2; ++again) {
      walk_to_operation();
      machine.request_stop();
      see(State::quick_stop_active);
      const Time begin = now;
      for (int i = 0; i < (stop == 0 && again == 0 ? 500 : 2000) && see(State::quick_stop_active) == 0x02; ++i) {
      }
      if (stop == 0 && again == 0) continue;  // it left by itself
      EXPECT_EQ(now - begin, StateMachine::quick_stop_time + 1ms) << "stop " << again + 1;
    }
  }
}

TEST_F(StateMachineTest, ResetOutsideOfFaultDoesNothing) {
  see(State::switch_on_disabled);
  machine.reset_fault();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(step(), 0x00);
  see(State::fault);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(step(), 0x00);
}

TEST_F(StateMachineTest, EnableIsRefusedInFaultAndOnItsWayThere) {
  for (const State state : {State::fault, State::fault_reaction_active}) {
    see(state);
    machine.request_enable();
    EXPECT_FALSE(machine.enable_wished()) << to_string(state);
  }
}

}  // namespace
