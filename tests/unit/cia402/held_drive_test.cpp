// A drive that did not obey a stop is kept in Pre-operational and looked at until a reset.
#include <vector>

#include "forced_stop_fixture.hpp"

namespace breakaway::test {
namespace {

class HeldDriveTest : public ForcedStopTest {};

// Whoever leads it besides would lead it again as soon as its PDOs pass.
TEST_F(HeldDriveTest, KeepsTheDriveFromItsPdosUntilAReset) {
  for (const bool reboots : {false, true}) {
    node.follows_sdo_controlword = !reboots;
    enable_and_be_forced();
    node.follows_sdo_controlword = true;
    run_for(200ms);
    node.commands.clear();
    for (int i = 0; i < 5000; ++i) {
      drive.request_enable();
      step(10.0F);
      ASSERT_EQ(node.nmt, NmtState::pre_operational) << i;
      ASSERT_EQ(feedback.state, DriveState::configuring) << i;
    }
    EXPECT_TRUE(node.commands.empty()) << reboots;
    drive.request_stop();
    expect_recovery();
  }
}

TEST_F(HeldDriveTest, ADriveThatIsStartedBySomebodyElseIsTakenBack) {
  enable_and_be_forced();
  for (int again = 0; again < 3; ++again) {
    run_for(500ms);
    ASSERT_EQ(node.nmt, NmtState::pre_operational);
    node.on_frame(canopen::nmt_frame(NmtCommand::start, node_id));
    node.commands.clear();
    run_for(std::chrono::milliseconds{node.objects[ScriptedDrive::key(0x1017, 0)]} +
            2ms);  // its next heartbeat says so
    EXPECT_EQ(node.nmt, NmtState::pre_operational);
    EXPECT_EQ(node.commands, (std::vector{NmtCommand::enter_pre_operational})) << "once a heartbeat";
  }
  expect_recovery();
}

// Whoever else leads it may go on: a reset waits for five looks without force.
TEST_F(HeldDriveTest, ADriveThatIsHeldShowsAsStoppingUntilItWasQuiet) {
  enable_and_be_forced();
  for (int i = 0; i < 79; ++i) {
    ASSERT_EQ(feedback.state, DriveState::stopping) << i;
    step();
  }
  run_for(10ms);
  EXPECT_EQ(feedback.state, DriveState::configuring);
}

// Five that were answered, however long that takes.
TEST_F(HeldDriveTest, ADriveThatIsHeldAndDoesNotAnswerIsNotQuiet) {
  enable_and_be_forced();
  run_for(50ms);
  node.silent = true;
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  node.silent = false;
  run_for(2s + 150ms);  // the newest look is awaited for as long
  EXPECT_EQ(feedback.state, DriveState::configuring);
}

TEST_F(HeldDriveTest, ADriveThatRefusesToBeLookedAtIsTakenForQuiet) {
  enable_and_be_forced();
  node.refused[ScriptedDrive::key(0x6041, 0)] = SdoAbort::no_such_object;
  run_for(120ms);
  EXPECT_EQ(feedback.state, DriveState::configuring);
}

TEST_F(HeldDriveTest, ALookThatMaySucceedLaterOrShowsNoStateSaysNothing) {
  enable_and_be_forced();
  node.refused[ScriptedDrive::key(0x6041, 0)] = SdoAbort::device_state;
  run_for(200ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  node.refused.clear();
  node.kept[ScriptedDrive::key(0x6041, 0)] = 0;
  run_for(200ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  node.kept.clear();
  expect_recovery();
}

// A code that may pass is one that a drive gives for good, too.
TEST_F(HeldDriveTest, ADriveThatRefusesEveryLookForAsLongAsASetUpWaitsIsTakenForQuiet) {
  for (const std::uint16_t object : {std::uint16_t{0x6041}, std::uint16_t{0x6077}}) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable_and_be_forced();
    node.refused[ScriptedDrive::key(object, 0)] = SdoAbort::device_state;
    run_for(2900ms);
    EXPECT_EQ(feedback.state, DriveState::stopping) << object;
    run_for(900ms);
    EXPECT_EQ(feedback.state, DriveState::configuring) << object;
    node.refused.clear();
    node.follows_sdo_controlword = true;
    expect_recovery();
  }
}

// It may have become slow, or be in NMT Stopped.
TEST_F(HeldDriveTest, ADriveThatIsHeldAndDoesNotAnswerIsAskedMorePatientlyAndTakenBack) {
  enable_and_be_forced();
  run_for(200ms);
  node.silent = true;
  std::vector<Duration> looks;
  int told = 0;
  const Time begin = now;
  while (now - begin < 5s) {
    step();
    for (const CanFrame& frame : sent) {
      told += frame.id == canopen::nmt_cob_id && frame.data[0] == 0x80 ? 1 : 0;
      if (frame.id == sdo_request_cob_id(node_id) && frame.data[0] == 0x40) looks.push_back(now - begin);
    }
  }
  ASSERT_EQ(looks.size(), 5U);
  EXPECT_EQ(looks[1] - looks[0], 53ms) << "and a frame each for NMT and the end of the last";
  EXPECT_EQ(looks[2] - looks[1], 303ms);
  EXPECT_EQ(looks[3] - looks[2], 1803ms);
  EXPECT_EQ(looks[4] - looks[3], 2003ms);
  EXPECT_EQ(told, 4);
  node.silent = false;
  expect_recovery();
}

TEST_F(HeldDriveTest, ADriveIsForcedOnWithTheLastMeansUntilFiveLooksWereQuiet) {
  struct Case {
    Duration quiet, least, most;  // without force, and then until the reset
  };
  for (const Case& one : {Case{20ms, 100ms, 200ms}, Case{75ms, 100ms, 200ms}, Case{130ms, 300ms, 330ms}}) {
    SCOPED_TRACE(one.quiet / 1ms);
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable_and_go_deaf();
    node.follows_sdo_controlword = false;
    node.commands.clear();
    drive.request_stop();
    run_until([&] { return was_told(NmtCommand::enter_pre_operational); });
    run_for(20ms);
    node.state = State::switch_on_disabled;
    run_until([&] { return !feedback.stop_not_obeyed; });
    ASSERT_FALSE(was_told(NmtCommand::reset_node));
    run_for(one.quiet);
    node.state = State::operation_enabled;
    run_until([&] { return feedback.stop_not_obeyed; });
    const Time begin = now;
    run_until([&] { return was_told(NmtCommand::reset_node); });
    EXPECT_GE(now - begin, one.least);
    EXPECT_LE(now - begin, one.most);
  }
}

// It was of no use, was forced, and is another one since.
TEST_F(HeldDriveTest, ADriveThatIsSetUpAfterItsStopIsForcedFromTheFirstMeans) {
  node.objects[ScriptedDrive::key(0x6502, 0)] = 0;
  node.boot();
  deliver();
  run_until([&] { return drive.setup_status() == SetupStatus::no_torque_mode; });
  node.state = State::operation_enabled;
  node.follows_controlword = node.follows_sdo_controlword = false;
  node.commands.clear();
  run_until([&] { return was_told(NmtCommand::enter_pre_operational); });
  run_for(20ms);
  node.state = State::switch_on_disabled;
  run_until([&] { return drive.setup_status() == SetupStatus::no_torque_mode; });
  node.objects[ScriptedDrive::key(0x6502, 0)] = 1U << 9;
  node.boot();
  deliver();
  run_until([&] { return node.nmt == NmtState::operational; });
  node.heartbeat();  // at once, before it is looked at five times
  run_until([&] { return drive.setup_status() == SetupStatus::ready; });
  node.commands.clear();
  node.state = State::operation_enabled;
  run_until([&] { return feedback.stop_not_obeyed; });
  const Time begin = now;
  run_until([&] { return was_told(NmtCommand::reset_node); });
  EXPECT_GE(now - begin, 300ms);
}

// Each look that shows force after one that did not would begin with the controlword for ever.
TEST_F(HeldDriveTest, AStatuswordThatChattersKeepsNoDriveFromItsReset) {
  for (const unsigned per_cent : {1U, 5U, 10U, 20U, 30U, 50U, 90U}) {
    SCOPED_TRACE(per_cent);
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable_and_go_deaf();
    node.follows_sdo_controlword = false;
    if (per_cent < 50)  // what shows no force more often than that is known by its torque only
      node.refused[ScriptedDrive::key(0x6077, 0)] = SdoAbort::no_such_object;
    else
      node.torque = 300;
    drive.request_stop();
    node.commands.clear();
    std::uint32_t random = per_cent;
    const Time begin = now;
    while (!was_told(NmtCommand::reset_node)) {
      ASSERT_LT(now - begin, 5s);
      random = random * 1664525U + 1013904223U;
      node.state = (random >> 16) % 100 < per_cent ? State::switch_on_disabled : State::operation_enabled;
      step();
      ASSERT_EQ(feedback.state, DriveState::stopping) << "a reset would be taken";
    }
    node.follows_sdo_controlword = true;
    node.torque = 0;
    expect_recovery();
  }
}

TEST_F(HeldDriveTest, ADriveThatIsHeldIsForcedAgainWhenSomebodyElseEnablesIt) {
  enable_and_be_forced();
  for (int again = 0; again < 20; ++again) {
    run_for(507ms);  // at any time between two looks
    node.state = State::operation_enabled;
    EXPECT_LE(time_until_without_force(), 25ms) << "a look, its answer and the controlword: it was told before";
    EXPECT_TRUE(feedback.stop_not_obeyed);
    run_until([&] { return !feedback.stop_not_obeyed; });
  }
  expect_recovery();
}

}  // namespace
}  // namespace breakaway::test
