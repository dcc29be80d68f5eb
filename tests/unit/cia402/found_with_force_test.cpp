// What is done to a drive that has force which nobody here wished for: as it is found, or while it is set up.
#include "forced_stop_fixture.hpp"

namespace breakaway::test {
namespace {

using FoundWithForceTest = ForcedStopTest;

TEST_F(FoundWithForceTest, ADriveThatSomebodyElseEnablesIsSwitchedOffAgain) {
  set_up();
  node.state = State::operation_enabled;
  node.follows_controlword = false;
  EXPECT_LE(time_until_without_force(), 30ms);
  expect_recovery();
}

// Another tool left it with force, and it says nothing by itself.
TEST_F(FoundWithForceTest, ADriveThatIsFoundEnabledIsSwitchedOffAtOnce) {
  node.nmt = NmtState::operational;
  node.state = State::operation_enabled;
  EXPECT_LE(time_until_without_force(), 3ms);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(node.target, 0);
}

// Its heartbeat shows Pre-operational no sooner than a period after it was told.
TEST_F(FoundWithForceTest, ADriveThatIsFoundEnabledIsSwitchedOffAgainWhenItIsFirstHeard) {
  node.nmt = NmtState::operational;
  node.state = State::operation_enabled;
  node.objects[ScriptedDrive::key(0x1017, 0)] = 100;
  node.sdo_requests_lost = 1;
  EXPECT_LE(time_until_without_force(), 105ms);
}

TEST_F(FoundWithForceTest, ADriveThatTakesTheTimeOfAStopDuringItsSetUpHasNoFault) {
  node.state = State::operation_enabled;
  node.follows_sdo_controlword = false;
  node.boot();
  node.state = State::operation_enabled;
  deliver();
  run_until_state(DriveState::stopping);
  for (int i = 0; i < 18; ++i) {
    step();
    ASSERT_FALSE(feedback.stop_not_obeyed);
  }
  node.state = State::switch_on_disabled;
  for (int i = 0; i < 100; ++i) {
    step();
    ASSERT_FALSE(feedback.stop_not_obeyed);
  }
}

// Before the set-up is over nobody knows what a PDO of the drive carries.
TEST_F(FoundWithForceTest, APdoIsNoProofWhereTheStopIsForcedDuringTheSetUp) {
  node.boot();
  node.state = State::operation_enabled;
  node.follows_sdo_controlword = false;
  deliver();
  run_until([&] { return feedback.stop_not_obeyed; });
  for (int i = 0; i < 20; ++i) {
    drive.on_frame({.frame = {.id = tpdo_cob_id(1, node_id), .size = 8, .data = {0x40, 0x02}}, .time = now});
    step();
    ASSERT_TRUE(feedback.stop_not_obeyed);
  }
}

TEST_F(FoundWithForceTest, ADriveThatIsFoundEnabledAndIgnoresItsControlwordIsForced) {
  node.nmt = NmtState::operational;
  node.state = State::operation_enabled;
  node.follows_sdo_controlword = false;
  node.objects[ScriptedDrive::key(0x1017, 0)] = 50;
  node.commands.clear();
  run_until([&] { return feedback.stop_not_obeyed; }, 200ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  EXPECT_LE(time_until_without_force(), ForcedStop::round_time);
  EXPECT_TRUE(was_told(NmtCommand::reset_node));
  node.follows_sdo_controlword = true;
  expect_recovery();
}

// Whenever another tool switches it on while it is set up, its force does not last.
TEST_F(FoundWithForceTest, ADriveThatSomebodyElseEnablesWhileItIsSetUpIsSwitchedOffAgain) {
  constexpr auto set_up_time = 200ms;
  for (Duration onset{}; onset < set_up_time; onset += 3ms) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    node.boot();
    deliver();
    run_for(onset);
    if (feedback.state == DriveState::disabled) return;  // the set-up is over
    node.state = State::operation_enabled;
    EXPECT_LE(time_until_without_force(), 50ms) << onset.count() << " ns into the set-up";
    expect_recovery();
  }
  FAIL() << "the set-up was never over";
}

// It says no boot-up, and is given two seconds for it.
TEST_F(FoundWithForceTest, ADriveThatIsWaitedForIsLookedAt) {
  node.boots_silently = true;
  run_until([&] { return was_told(NmtCommand::reset_communication); });
  run_for(50ms);
  node.state = State::operation_enabled;
  EXPECT_LE(time_until_without_force(), 60ms);
}

TEST_F(FoundWithForceTest, ForceThatIsSeenDuringTheSetUpShowsAsStopping) {
  node.boot();
  deliver();
  run_for(5ms);
  node.state = State::operation_enabled;
  node.follows_sdo_controlword = false;
  run_until_state(DriveState::stopping);
  EXPECT_FALSE(feedback.stop_not_obeyed) << "it is given the time of a stop";
  run_for(25ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
}

}  // namespace
}  // namespace breakaway::test
