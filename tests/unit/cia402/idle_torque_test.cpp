// A drive that reports torque in a state without force.
#include <initializer_list>

#include "forced_stop_fixture.hpp"

namespace breakaway::test {
namespace {

class IdleTorqueTest : public ForcedStopTest {};

TEST_F(IdleTorqueTest, TorqueThatStaysInAStateWithoutForceIsForce) {
  for (const std::int16_t torque : std::initializer_list<std::int16_t>{51, -51}) {
    enable();
    drive.request_stop();
    run_until_state(DriveState::disabled);
    node.torque = torque;
    run_for(1s + 2ms);  // the first sample comes a period later, and is taken in by the next
    EXPECT_EQ(feedback.state, DriveState::disabled) << "a report may be filtered";
    EXPECT_FALSE(feedback.stop_not_obeyed);
    run_until([&] { return feedback.stop_not_obeyed; }, 30ms);
    node.commands.clear();
    node.written.clear();
    run_for(50ms);
    EXPECT_TRUE(feedback.stop_not_obeyed) << "its state says nothing";
    EXPECT_GT(node.written.size(), 5U);
    run_for(60ms);
    EXPECT_TRUE(was_told(NmtCommand::enter_pre_operational));
    node.torque = torque > 0 ? 50 : -50;
    run_until([&] { return !feedback.stop_not_obeyed; }, 10ms);
    EXPECT_FALSE(was_told(NmtCommand::reset_node)) << "it was not necessary";
    expect_recovery();
    drive.request_stop();
    run_until_state(DriveState::disabled);
  }
}

// What it has then is the drive's own to take off.
TEST_F(IdleTorqueTest, TorqueHasItsTimeAnewAfterAStateWithForce) {
  set_up();
  node.torque = 500;
  run_for(900ms);
  drive.request_enable();
  run_until_state(DriveState::enabled);
  drive.request_stop();
  run_until_state(DriveState::disabled);
  run_for(950ms);
  EXPECT_FALSE(feedback.stop_not_obeyed);
  run_until([&] { return feedback.stop_not_obeyed; }, 100ms);
}

TEST_F(IdleTorqueTest, TorqueThatStaysEndsInAReset) {
  set_up();
  node.torque = 500;
  run_until([&] { return was_told(NmtCommand::reset_node); });
  EXPECT_TRUE(feedback.stop_not_obeyed);
  node.torque = 0;
  expect_recovery();
}

// A sample from elsewhere, or one that was lost in a gateway.
TEST_F(IdleTorqueTest, OneSampleEndsNoStopThatTorqueBrought) {
  set_up();
  node.torque = 500;
  run_until([&] { return feedback.stop_not_obeyed; });
  node.sdo_requests_lost = 1000;
  node.torque = 0;
  step();
  node.torque = 500;
  run_for(10ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  node.state = State::not_ready_to_switch_on;
  step();
  node.state = State::switch_on_disabled;
  run_for(10ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  node.sdo_requests_lost = 0;
  node.torque = 0;
  expect_recovery();
}

TEST_F(IdleTorqueTest, AReadOfTheTorqueThatMaySucceedLaterIsNoProof) {
  set_up();
  node.refused[ScriptedDrive::key(0x6077, 0)] = SdoAbort::device_state;
  node.torque = 500;
  run_until([&] { return feedback.stop_not_obeyed; });
  run_for(90ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  node.refused.clear();
  node.torque = 0;
  run_until([&] { return !feedback.stop_not_obeyed; }, 10ms);
  expect_recovery();
}

TEST_F(IdleTorqueTest, ADriveWhoseTorqueCannotBeReadIsBelievedForItsState) {
  set_up();
  node.refused[ScriptedDrive::key(0x6077, 0)] = SdoAbort::no_such_object;
  node.torque = 500;
  run_until([&] { return feedback.stop_not_obeyed; });
  node.commands.clear();
  run_until([&] { return !feedback.stop_not_obeyed; }, 20ms);
  EXPECT_FALSE(was_told(NmtCommand::reset_node));
}

TEST_F(IdleTorqueTest, TorqueThatStaysAfterAResetIsForceAgainAfterTheSameTime) {
  set_up();
  node.torque = 500;
  run_until([&] { return feedback.stop_not_obeyed; });
  node.torque = 0;
  run_until([&] { return !feedback.stop_not_obeyed && feedback.state != DriveState::stopping; });
  drive.reset_fault();
  step();
  node.torque = 500;
  run_until_state(DriveState::disabled);
  const Time begin = now;
  run_until([&] { return feedback.stop_not_obeyed; });
  EXPECT_GE(now - begin, 1s);
}

// The drive says that it obeys, and no PDO tells it anything.
TEST_F(IdleTorqueTest, TorqueThatStaysAfterAStopByObjectIsTakenOffByAReset) {
  enable_and_go_deaf();
  node.torque = 300;
  node.commands.clear();
  drive.request_stop();
  run_until([&] { return feedback.stop_not_obeyed; }, 30ms);
  run_until([&] { return was_told(NmtCommand::reset_node); }, 350ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  EXPECT_EQ(node.state, State::switch_on_disabled);
  run_for(200ms);
  EXPECT_TRUE(feedback.stop_not_obeyed || feedback.state == DriveState::stopping) << "a boot-up alone ends no torque";
  node.torque = 0;
  expect_recovery();
}

TEST_F(IdleTorqueTest, TorqueInALookAtADriveThatIsHeldIsForceAtOnce) {
  for (const Duration held : std::initializer_list<Duration>{7ms, 45ms, 1s}) {
    SCOPED_TRACE(held.count());
    enable_and_be_forced();
    run_for(held);
    node.written.clear();
    node.torque = -51;
    run_until([&] { return feedback.stop_not_obeyed; }, 30ms);
    EXPECT_EQ(feedback.state, DriveState::stopping);
    node.commands.clear();
    run_until([&] { return was_told(NmtCommand::reset_node); }, 350ms);
    EXPECT_FALSE(node.written.empty());
    node.torque = -50;
    expect_recovery();
  }
}

TEST_F(IdleTorqueTest, ADriveWithoutTheObjectOfTheTorqueIsAskedForItOnceAStop) {
  node.refused[ScriptedDrive::key(0x6077, 0)] = SdoAbort::no_such_object;
  for (int again = 0; again < 2; ++again) {
    enable_and_go_deaf();
    drive.request_stop();
    int asked = 0;
    for (int i = 0; i < 500; ++i) {
      step();
      for (const CanFrame& frame : sent)
        asked += frame.id == sdo_request_cob_id(node_id) && frame.data[0] == 0x40 && frame.data[1] == 0x77 ? 1 : 0;
    }
    EXPECT_EQ(asked, 1);
    EXPECT_FALSE(feedback.stop_not_obeyed);
    EXPECT_EQ(feedback.state, DriveState::configuring) << "quiet by its state";
    expect_recovery();
  }
}

// A current measurement has an offset, and what is enabled has its torque for a reason.
TEST_F(IdleTorqueTest, ALittleTorqueOrOneThatDecaysOrThatOfAnEnabledDriveIsNone) {
  set_up();
  for (const std::int16_t torque : std::initializer_list<std::int16_t>{50, -50}) {
    node.torque = torque;
    run_for(2s);
    EXPECT_EQ(feedback.state, DriveState::disabled) << torque;
  }
  for (int i = 0; i < 3; ++i) {
    node.torque = 1000;
    run_for(990ms);
    node.torque = 0;
    run_for(3ms);
  }
  EXPECT_EQ(feedback.state, DriveState::disabled);
  drive.request_enable();
  run_until_state(DriveState::enabled);
  node.torque = 1000;
  run_for(2s);
  EXPECT_EQ(feedback.state, DriveState::enabled);
  node.torque = 0;
}

}  // namespace
}  // namespace breakaway::test
