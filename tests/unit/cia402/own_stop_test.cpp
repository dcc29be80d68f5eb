// The time that a drive has which stops by itself: by a quick stop that it stays in, or the reaction to a fault.
#include "forced_stop_fixture.hpp"

namespace breakaway::test {
namespace {

using OwnStopTest = ForcedStopTest;

TEST_F(OwnStopTest, GivesAQuickStopTheTimeThatItMayTake) {
  enable();
  drive.request_stop();
  run_until_state(DriveState::stopping);
  ASSERT_EQ(node.state, State::quick_stop_active);
  node.follows_controlword = false;  // stays in it, as the options 5 to 8 of 605Ah want
  node.written.clear();
  run_for(StateMachine::quick_stop_time);
  EXPECT_TRUE(node.written.empty()) << "it was forced";
  EXPECT_LE(time_until_without_force(), 2 * Drive<float>::stop_time + 10ms);
  expect_recovery();
}

// Told twice, to stop and then to be without voltage, it obeys each within the time of a stop.
TEST_F(OwnStopTest, BlamesNoDriveThatTakesTheTimeOfAStopForItsQuickStopAndAgainToLeaveIt) {
  constexpr Duration takes = Drive<float>::stop_time - 3ms;
  enable();
  node.follows_controlword = false;
  drive.request_stop();
  run_for(takes);
  node.state = State::quick_stop_active;
  run_until([&] { return (node.controlword & 0x02U) == 0; });  // disable voltage
  run_for(takes);
  node.state = State::switch_on_disabled;
  run_for(100ms);
  EXPECT_FALSE(feedback.stop_not_obeyed);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), SetupStatus::ready) << "it was forced";
}

// The last sample that shows it comes late, together with the one that shows that it is over.
TEST_F(OwnStopTest, BlamesNoDriveWhoseStopByItselfEndsWithTwoSamplesInAPeriod) {
  for (const State own : {State::quick_stop_active, State::fault_reaction_active}) {
    enable();
    node.state = own;
    node.follows_controlword = false;
    run_for(3 * Drive<float>::stop_time);
    ASSERT_EQ(feedback.state, DriveState::stopping);
    node.on_frame(breakaway::canopen::sync_frame());
    node.state = State::switch_on_disabled;
    node.on_frame(breakaway::canopen::sync_frame());
    node.sends_tpdo = false;
    step();
    EXPECT_FALSE(feedback.stop_not_obeyed) << "of state " << static_cast<int>(own);
    node.sends_tpdo = node.follows_controlword = true;
    run_for(100ms);
    EXPECT_EQ(feedback.state, DriveState::disabled);
    EXPECT_EQ(drive.setup_status(), SetupStatus::ready) << "it was forced";
  }
}

// It was in Operation enabled for less than a period.
TEST_F(OwnStopTest, AQuickStopBeforeOperationEnabledWasSeenHasNoMoreTimeThanAnother) {
  set_up();
  drive.request_enable();
  run_until([&] { return node.state == State::switched_on; });
  node.follows_controlword = false;
  node.state = State::quick_stop_active;
  const Duration took = time_until_without_force();
  EXPECT_GT(took, StateMachine::quick_stop_time);
  EXPECT_LE(took, StateMachine::quick_stop_time + 2 * Drive<float>::stop_time + 10ms);
  expect_recovery();
}

}  // namespace
}  // namespace breakaway::test
