// What is done to a drive that was told to stop and keeps its force.
#include "forced_stop_fixture.hpp"

namespace breakaway::test {
namespace {

TEST_F(ForcedStopTest, ADriveThatObeysIsToldByPdoOnly) {
  enable();
  node.written.clear();
  drive.request_stop();
  run_for(500ms);
  EXPECT_TRUE(node.written.empty());
  EXPECT_FALSE(feedback.stop_not_obeyed);
}

// Another node says so with the drive's own identifier, behind its own sample.
TEST_F(ForcedStopTest, AForeignStatuswordThatSaysTheDriveStopsByItselfGivesItNoMoreTime) {
  for (const State lie : {State::quick_stop_active, State::fault_reaction_active, State::fault}) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable_and_go_deaf();
    CanFrame frame{.id = tpdo_cob_id(1, node_id), .size = 8};
    canopen::store_little_endian(frame.data, cia402::status_bits(lie), 0);
    drive.request_stop();
    const Time begin = now;
    while (!feedback.stop_not_obeyed) {
      ASSERT_LT(now - begin, 30ms);
      step(10.0F);
      drive.on_frame({.frame = frame, .time = now + 400us});
      ASSERT_TRUE(feedback.state == DriveState::stopping || now - begin <= 1ms) << "a reset would be taken";
    }
  }
}

// What it said in the period before was Operation enabled.
TEST_F(ForcedStopTest, ADriveThatTripsMayNotBeResetBeforeItHasShownNoForceForAsLongAsAStopTakes) {
  enable();
  node.state = State::fault;
  run_until([&] { return feedback.faulty; });
  for (int i = 0; i < 19; ++i) {
    ASSERT_EQ(feedback.state, DriveState::stopping) << i;
    step();
  }
  EXPECT_EQ(feedback.fault_code, 0x2310) << "why is told meanwhile";
  run_for(2ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
}

// A sample that shows no force, and then the loop is late.
TEST_F(ForcedStopTest, ALatePeriodIsNoTimeInWhichTheDriveShowedNoForce) {
  for (const Duration late : {0ms, 15ms, 21ms, 100ms}) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable_and_go_deaf();
    drive.request_stop();
    const Time begin = now;
    for (int i = 0; !feedback.stop_not_obeyed; ++i) {
      ASSERT_LT(i, 40) << late / 1ms;
      node.state = i % 10 == 9 ? State::switch_on_disabled : State::operation_enabled;
      if (i % 10 == 0) now += late;
      step();
      ASSERT_EQ(feedback.state, DriveState::stopping) << late / 1ms << " ms, period " << i;
    }
    EXPECT_GT(now - begin, 20ms);
  }
}

// The stop left with the last period, and what the drive did since was not heard.
TEST_F(ForcedStopTest, ALoopThatStandsStillRightAfterAStopBlamesNoDriveForIt) {
  for (const Duration pause : {19ms, 21ms, 50ms, 500ms}) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable();
    step(10.0F);
    drive.request_stop();
    step();
    now += pause;
    for (int i = 0; i < 100; ++i) {
      step();
      ASSERT_FALSE(feedback.stop_not_obeyed) << pause / 1ms << " ms, step " << i;
    }
    EXPECT_EQ(feedback.state, DriveState::disabled);
  }
}

TEST_F(ForcedStopTest, ADriveThatIgnoresItsStopIsForcedThoughTheLoopIsLateInEveryPeriod) {
  enable_and_go_deaf();
  drive.request_stop();
  int steps = 0;
  for (; steps < 100 && !feedback.stop_not_obeyed; ++steps) {
    now += 9ms;
    step();
  }
  EXPECT_LE(steps, 13) << "of which each counts for two periods";
  EXPECT_GE(steps, 11);
}

TEST_F(ForcedStopTest, WritesTheControlwordByObjectToADriveWithoutRpdo) {
  enable_and_go_deaf();
  node.commands.clear();
  drive.request_stop();
  run_for(19ms);
  EXPECT_FALSE(feedback.stop_not_obeyed) << "a stop takes this long";
  EXPECT_LE(time_until_without_force(), 5ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  EXPECT_FALSE(was_told(NmtCommand::enter_pre_operational)) << "it was not necessary";
  expect_recovery();
}

TEST_F(ForcedStopTest, SendsADriveThatIgnoresItsControlwordToPreOperational) {
  enable_and_go_deaf();
  node.follows_sdo_controlword = false;
  node.stops_in_pre_operational = true;
  node.commands.clear();
  drive.request_stop();
  EXPECT_LE(time_until_without_force(), 20ms + ForcedStop::controlword_time + 5ms);
  EXPECT_FALSE(was_told(NmtCommand::reset_node));
  node.follows_sdo_controlword = true;
  expect_recovery();
}

TEST_F(ForcedStopTest, ResetsADriveThatIgnoresEverythingElse) {
  enable_and_go_deaf();
  node.follows_sdo_controlword = false;
  drive.request_stop();
  EXPECT_LE(time_until_without_force(), 20ms + ForcedStop::controlword_time + ForcedStop::pre_operational_time + 5ms);
  EXPECT_TRUE(was_told(NmtCommand::reset_node));
  run_for(5ms);
  EXPECT_FALSE(feedback.ever_valid) << "what booted lost its reference";
  node.follows_sdo_controlword = true;
  expect_recovery();
}

TEST_F(ForcedStopTest, GoesOnWhileADriveSaysNothing) {
  enable();
  step(10.0F);
  node.silent = true;
  drive.request_stop();
  for (int round = 0; round < 3; ++round) {
    run_for(ForcedStop::round_time);
    EXPECT_TRUE(feedback.stop_not_obeyed) << "silence is no proof";
    EXPECT_EQ(feedback.state, DriveState::stopping);
  }
  node.silent = false;
  EXPECT_LE(time_until_without_force(), ForcedStop::round_time);
  expect_recovery();
}

TEST_F(ForcedStopTest, ADriveThatRebootedUnheardIsSetUpAnew) {
  enable();
  step(10.0F);
  node.silent = true;
  drive.request_stop();
  run_for(500ms);
  node.boot();
  node.silent = false;
  expect_recovery();
}

TEST_F(ForcedStopTest, IsNotEnabledWhileItGoesOn) {
  enable_and_go_deaf();
  node.follows_sdo_controlword = false;
  drive.request_stop();
  run_for(50ms);
  ASSERT_TRUE(feedback.stop_not_obeyed);
  node.follows_controlword = true;
  for (int i = 0; i < 3000; ++i) {
    drive.request_enable();
    step(10.0F);
    ASSERT_EQ(node.target, 0);
    ASSERT_NE(node.controlword & 0x0F, 0x0F) << "at " << i << " ms";
    if (!feedback.stop_not_obeyed) break;
  }
  EXPECT_FALSE(feedback.stop_not_obeyed);
  node.follows_sdo_controlword = true;
  drive.reset_fault();
  run_until_state(DriveState::disabled);
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::disabled) << "what was asked for meanwhile is forgotten";
}

// A boot-up message may be another node's of the same id.
TEST_F(ForcedStopTest, ADriveWhoseBootUpIsNotItsOwnIsToldByItsPdoToBeWithoutForce) {
  enable();
  step(10.0F);
  node.sdo_requests_lost = 1000;  // its turn may come late
  drive.on_frame({.frame = canopen::heartbeat_frame(NmtState::boot_up, node_id), .time = now});
  drive.on_frame({.frame = canopen::heartbeat_frame(NmtState::boot_up, node_id), .time = now});
  now += 1ms;
  drive.update(now);
  drive.command(10.0F);
  CanFrame frame;
  ASSERT_TRUE(drive.next_command_frame(frame));
  node.on_frame(frame);
  EXPECT_EQ(node.controlword, 0);
  EXPECT_EQ(node.target, 0);
  EXPECT_TRUE(without_force());
  EXPECT_EQ(drive.reboots(), 1U) << "and it is set up as if it were new";
  node.sdo_requests_lost = 0;
  expect_recovery();
}

TEST_F(ForcedStopTest, ADriveThatBootedAnewIsSentNoPdoOnceItAnswered) {
  enable();
  node.boot();
  deliver();
  run_until([&] { return node.value_of(0x1016, 1) != 0U; });  // its set-up
  CanFrame frame;
  EXPECT_FALSE(drive.next_command_frame(frame));
}

TEST_F(ForcedStopTest, AStatuswordInAPdoIsAProofToo) {
  enable_and_go_deaf();
  node.refused[ScriptedDrive::key(0x6041, 0)] = breakaway::canopen::SdoAbort::write_only;
  node.commands.clear();
  drive.request_stop();
  run_until([&] { return feedback.stop_not_obeyed; });
  run_until([&] { return !feedback.stop_not_obeyed; }, 20ms);
  EXPECT_TRUE(without_force());
  EXPECT_FALSE(was_told(NmtCommand::reset_node));
}

// Beside PDOs that pass, SDO is not answered.
TEST_F(ForcedStopTest, AStatuswordInAPdoIsNoProofBesideTorque) {
  for (const std::int16_t torque : {std::int16_t{51}, std::int16_t{-51}, std::int16_t{50}, std::int16_t{-50}}) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    enable_and_go_deaf();
    node.follows_sdo_controlword = false;
    drive.request_stop();
    run_until([&] { return feedback.stop_not_obeyed; });
    node.sdo_requests_lost = 1000;
    node.torque = torque;
    node.state = State::switch_on_disabled;
    run_for(20ms);
    EXPECT_EQ(feedback.stop_not_obeyed, std::abs(torque) > 50) << torque;
  }
}

TEST_F(ForcedStopTest, AStatuswordOfZerosIsNoProof) {
  enable_and_go_deaf();
  node.follows_sdo_controlword = false;
  drive.request_stop();
  run_until([&] { return feedback.stop_not_obeyed; });
  node.state = State::not_ready_to_switch_on;
  run_for(50ms);
  EXPECT_TRUE(feedback.stop_not_obeyed);
}

TEST_F(ForcedStopTest, ADriveThatShowsNoStateAfterAStopIsNotShownAsDisabled) {
  enable_and_go_deaf();
  drive.request_stop();
  run_for(2ms);
  node.state = State::not_ready_to_switch_on;
  run_for(5ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  node.state = State::switch_on_disabled;
  run_until_state(DriveState::disabled);
}

// In place of the drive's own, so that nothing in that period tells otherwise.
TEST_F(ForcedStopTest, AFalseStatuswordNowAndThenNeitherEndsAStopNorShowsTheDriveAsDisabled) {
  for (const int every : {2, 7, 15, 20}) {
    SCOPED_TRACE(every);
    enable_and_go_deaf();
    drive.request_stop();
    int periods = 0;
    for (; !feedback.stop_not_obeyed && periods < 100; ++periods) {
      node.state = periods % every == every - 1 ? State::switch_on_disabled : State::operation_enabled;
      step();
      EXPECT_EQ(feedback.state, DriveState::stopping) << periods;
    }
    EXPECT_LE(periods, 25);
    node.state = State::operation_enabled;
    expect_recovery();
    node.commands.clear();
  }
}

TEST_F(ForcedStopTest, ADriveThatSaysThatItIsNotOperationalIsToldToStopAllTheSame) {
  enable();
  step(10.0F);
  node.out.push_back(canopen::heartbeat_frame(NmtState::pre_operational, node_id));
  deliver();
  drive.request_stop();
  node.follows_sdo_controlword = false;
  EXPECT_LE(time_until_without_force(), 2ms);
  EXPECT_FALSE(feedback.stop_not_obeyed);
}

class PatientForcedStopTest : public ForcedStopTest {
 protected:
  PatientForcedStopTest()
      : ForcedStopTest{[] {
          DriveConfig<float> patient = config;
          patient.sdo_timeout = 1s;
          return patient;
        }()} {}
};

TEST_F(PatientForcedStopTest, WritesTheControlwordAgainWithEachMeans) {
  enable_and_go_deaf();
  node.sdo_requests_lost = 1;
  drive.request_stop();
  EXPECT_LE(time_until_without_force(), 20ms + ForcedStop::controlword_time + 5ms);
}

}  // namespace
}  // namespace breakaway::test
