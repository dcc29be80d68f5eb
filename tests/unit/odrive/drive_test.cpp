#include "breakaway/odrive/drive.hpp"

#include "obedient_node.hpp"

namespace breakaway::odrive::test {
namespace {

using hal::DriveState;

constexpr float step_Nm = 1.0F / 16384;

class OdriveDrive : public DriveTest {};

class PolledOdrive : public DriveTest {
 protected:
  static DriveConfig<float> polled_config() {
    auto c = config;
    c.estimates = Estimates::polled;
    return c;
  }
  PolledOdrive() : DriveTest{polled_config()} {}
};

TEST_F(OdriveDrive, IsSilentUntilItsNodeIsHeard) {
  node.silent = node.blind = true;
  run(500ms);
  EXPECT_TRUE(node.told.empty());
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_heartbeat);
}

TEST_F(OdriveDrive, IsToldTorqueModeBeforeItIsReady) {
  set_up();
  EXPECT_EQ(told(Command::set_controller_mode), 1);
  EXPECT_EQ(told(Command::set_axis_state), 0) << "it was idle already";
  EXPECT_EQ(told(Command::set_limits), 0) << "none are given";
  EXPECT_EQ(torque_Nm, 0.0F) << "its watchdog is fed from the first on";
}

TEST_F(OdriveDrive, IsToldItsLimitsWhereTheyAreGiven) {
  auto c = config;
  c.velocity_limit_turns_s = 30;
  c.current_limit_A = 12;
  drive = Drive<float>{c, network, scale};
  set_up();
  EXPECT_EQ(node.limit_turns_s, 30);
  EXPECT_EQ(node.limit_A, 12);
}

TEST_F(OdriveDrive, OfOldFirmwareIsUnusable) {
  node.minor = 5;
  run(300ms);
  EXPECT_EQ(feedback.state, DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::firmware_too_old);
  node.told.clear();
  run(300ms);
  EXPECT_TRUE(node.told.empty());
}

TEST_F(OdriveDrive, OfFirmwareThatIsNewerByItsFirstNumberIsUsed) {
  node.major = 1;
  node.minor = 0;
  set_up();
}

TEST_F(OdriveDrive, OfOldFirmwareIsAskedAnewWhenItsFaultIsReset) {
  node.minor = 5;
  run(300ms);
  ASSERT_EQ(feedback.state, DriveState::unusable);
  node.minor = 6;
  run(300ms);
  EXPECT_EQ(feedback.state, DriveState::unusable) << "nobody has said that it was mended";
  drive.reset_fault();
  run(300ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveDrive, ThatFallsSilentAsItStartsIsSaidToBeSilent) {
  node.answers_version = false;
  run(150ms);
  ASSERT_EQ(drive.setup_status(), SetupStatus::no_version);
  node.errors = error::initializing;
  run(100ms);
  node.silent = true;
  run(400ms);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_heartbeat);
}

TEST_F(OdriveDrive, ThatDoesNotSayItsVersionIsNotUsed) {
  node.answers_version = false;
  run(1s);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_version);
  EXPECT_EQ(told(Command::set_controller_mode), 0);
}

TEST_F(OdriveDrive, WithoutEstimatesIsNotReady) {
  node.blind = true;
  run(500ms);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_estimates);
  node.blind = false;
  run(10ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveDrive, ThatStillStartsIsWaitedFor) {
  node.errors = error::initializing;
  run(300ms);
  EXPECT_EQ(drive.setup_status(), SetupStatus::starting);
  node.errors = 0;
  run(300ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveDrive, ThatSomebodyLeftEnergisedIsStoppedFirst) {
  node.state = AxisState::closed_loop_control;
  run(101ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  run(300ms);
  EXPECT_EQ(node.state, AxisState::idle);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_FALSE(feedback.stop_not_obeyed);
}

TEST_F(OdriveDrive, FollowsForceOnceEnabled) {
  enable();
  step(20);
  EXPECT_NEAR(*torque_Nm, 0.4F, step_Nm);
  step(-20);
  EXPECT_NEAR(*torque_Nm, -0.4F, step_Nm);
}

TEST_F(OdriveDrive, GivesNothingBeforeItIsEnabled) {
  set_up();
  drive.command(20);
  step();
  EXPECT_EQ(torque_Nm, 0.0F);
  drive.request_enable();
  for (int i = 0; i < 20; ++i) {
    drive.command(20);
    step();
    if (feedback.state != DriveState::enabled) {
      EXPECT_EQ(torque_Nm, 0.0F);
    }
  }
}

TEST_F(OdriveDrive, ActsOnceOnACommand) {
  enable();
  drive.command(20);
  hal::CanFrame frame;
  ASSERT_TRUE(drive.next_command_frame(frame));
  EXPECT_NE(load_float(frame, 0), 0);
  ASSERT_TRUE(drive.next_command_frame(frame));
  EXPECT_EQ(load_float(frame, 0), 0);
}

TEST_F(OdriveDrive, NeverExceedsTheAxisLimitOrTakesWhatIsNoNumber) {
  enable();
  step(1e9F);
  EXPECT_NEAR(*torque_Nm, 0.8F, step_Nm);
  step(-1e9F);
  EXPECT_NEAR(*torque_Nm, -0.8F, step_Nm);
  step(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(*torque_Nm, 0);
  step(std::numeric_limits<float>::infinity());
  EXPECT_EQ(*torque_Nm, 0);
}

TEST_F(OdriveDrive, ShowsPositionFromItsDatumTravelAndForce) {
  set_up();
  drive.set_datum_counts(300000);
  node.turns = 2.5F;
  node.torque_Nm = 0.01F;
  step();
  EXPECT_TRUE(feedback.fresh);
  EXPECT_FLOAT_EQ(feedback.position_m, 0.25F);
  EXPECT_FLOAT_EQ(feedback.position_offset_m, -0.05F);
  EXPECT_FLOAT_EQ(feedback.travel_m, 0.25F);
  EXPECT_FLOAT_EQ(feedback.force_N, 0.5F);
  EXPECT_EQ(feedback.sample_time, now);
}

TEST_F(OdriveDrive, ReportsNoForceThatIsOld) {
  enable();
  node.torque_Nm = 0.4F;
  step();
  EXPECT_FLOAT_EQ(feedback.force_N, 20);
  node.blind = true;
  run(5ms);
  EXPECT_EQ(feedback.force_N, 0);
}

TEST_F(OdriveDrive, IsToldToStopAtOnceWhenItWasJustToldToEnable) {
  set_up();
  drive.request_enable();
  while (node.state != AxisState::closed_loop_control) step();
  drive.request_stop();
  step();
  EXPECT_EQ(node.state, AxisState::idle);
}

TEST_F(OdriveDrive, StopsByIdleAndSaysSoWhenItIsSeen) {
  enable();
  drive.request_stop();
  step(20);
  EXPECT_EQ(torque_Nm, 0.0F);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  EXPECT_EQ(node.state, AxisState::idle) << "at once";
  run(110ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(told(Command::estop), 0);
}

TEST_F(OdriveDrive, ThatWasStoppedOnItsWayIsNotTakenForIdleByAnOldHeartbeat) {
  set_up();
  drive.request_enable();
  while (node.state != AxisState::closed_loop_control) step();
  node.deaf = true;
  drive.request_stop();
  auto old = node;
  old.state = AxisState::idle;
  deliver(old.heartbeat());
  step();
  EXPECT_EQ(feedback.state, DriveState::stopping) << "no heartbeat has shown it enabled, and it is";
  run(50ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  node.deaf = false;
  run(250ms);
  EXPECT_EQ(node.state, AxisState::idle);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveDrive, WithInvertedDirectionTurnsPositionAndForceRound) {
  auto c = config;
  c.invert_direction = true;
  drive = Drive<float>{c, network, scale};
  enable();
  node.turns = 1;
  node.torque_Nm = 0.4F;
  step(20);
  EXPECT_NEAR(*torque_Nm, -0.4F, step_Nm);
  EXPECT_FLOAT_EQ(feedback.position_m, -0.1F);
  EXPECT_FLOAT_EQ(feedback.force_N, -20);
}

TEST_F(OdriveDrive, StandsAtItsHomeWhenItIsEnabledFirst) {
  auto c = config;
  c.home_here = true;
  c.home_counts = 1234;
  drive = Drive<float>{c, network, scale};
  node.turns = 7;
  enable();
  EXPECT_EQ(drive.position_counts(), 1234);
  node.turns = 7.5F;
  step();
  EXPECT_EQ(drive.position_counts(), 51234);
}

class OdriveHomedWhereItStands : public DriveTest {
 protected:
  static DriveConfig<float> homed_config() {
    auto c = config;
    c.home_here = true;
    c.home_counts = 1234;
    return c;
  }
  OdriveHomedWhereItStands() : DriveTest{homed_config()} {}
};

TEST_F(OdriveHomedWhereItStands, IsHomedAnewAfterItLostItsReferenceAndWasReset) {
  enable();
  node.silent = true;
  run(400ms);
  ASSERT_TRUE(drive.reference_lost());
  node.silent = false;
  node.turns = 3;
  run(600ms);
  drive.reset_fault();
  enable();
  EXPECT_EQ(drive.position_counts(), 1234);
  EXPECT_FALSE(drive.reference_lost());
}

TEST_F(OdriveHomedWhereItStands, KeepsTheReferenceThatItHasWhenItIsReset) {
  enable();
  drive.request_stop();
  node.turns = 0.5F;
  run(300ms);
  drive.reset_fault();
  enable();
  EXPECT_EQ(drive.position_counts(), 51234);
}

TEST_F(PolledOdrive, AsksForItsSamplesOnceAPeriod) {
  set_up();
  questions = 0;
  run(100ms);
  EXPECT_EQ(questions, 200);
  node.turns = 3;
  run(2ms);
  EXPECT_FLOAT_EQ(feedback.position_m, 0.3F);
}

TEST_F(PolledOdrive, IsSeenToBeEnabledAndStoppedWithoutWaitingForItsHeartbeat) {
  set_up();
  node.silent = false;
  drive.request_enable();
  run(20ms);
  EXPECT_EQ(feedback.state, DriveState::enabled);
  drive.request_stop();
  run(20ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

}  // namespace
}  // namespace breakaway::odrive::test
