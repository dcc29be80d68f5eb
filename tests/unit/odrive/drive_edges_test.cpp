// Ties and defaults of a drive: what counts as double or as old, what is so before anything was heard, and which axis
// stands at its home.
#include <cmath>
#include <limits>

#include "breakaway/odrive/drive.hpp"
#include "obedient_node.hpp"

namespace breakaway::odrive::test {
namespace {

using hal::DriveState;

class OdriveEdges : public DriveTest {
 protected:
  static DriveConfig<float> with_home() {
    auto c = config;
    c.home_here = true;
    c.home_counts = 1234;
    return c;
  }
  // A period in which so many estimates come.
  void step_with(int samples) {
    for (int i = 1; i < samples; ++i) deliver(node.estimates());
    step();
  }
  void stop() {
    drive.request_stop();
    run(300ms);
    ASSERT_EQ(feedback.state, DriveState::disabled);
  }
};

class PolledOdriveEdges : public DriveTest {
 protected:
  static DriveConfig<float> polled_config() {
    auto c = config;
    c.estimates = Estimates::polled;
    c.estimate_period = 500us;  // of cyclic ones, which these are not
    return c;
  }
  PolledOdriveEdges() : DriveTest{polled_config()} {}
};

TEST_F(OdriveEdges, ShowsNothingBeforeAnythingWasHeard) {
  EXPECT_EQ(drive.position_counts(), 0);
  feedback = drive.feedback();
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(feedback.position_m, 0);
  EXPECT_EQ(feedback.position_offset_m, 0);
  EXPECT_EQ(feedback.travel_m, 0);
  EXPECT_EQ(feedback.force_N, 0);
  EXPECT_FALSE(feedback.fresh || feedback.ever_valid || feedback.stop_not_obeyed || feedback.homing_failed);
  EXPECT_EQ(feedback.fault_code, 0);
  EXPECT_FALSE(drive.reference_lost() || drive.heartbeat_lost() || drive.node_id_conflict());
  hal::CanFrame frame;
  EXPECT_FALSE(drive.next_command_frame(frame) || drive.next_poll_frame(frame) || drive.next_acyclic_frame(frame, now));
}

TEST_F(OdriveEdges, SaysWhatItIsAndHowItStands) {
  EXPECT_EQ(drive.node_id(), 5);
  EXPECT_EQ(drive.encoder_resolution_m(), scale.encoder_resolution_m);
  EXPECT_EQ(drive.config_error(), DriveConfigError::none);
  EXPECT_NEAR(drive.max_force_N(), 40, 50.0F / 16384);
  EXPECT_EQ(drive.axis_state(), AxisState::undefined);
  EXPECT_EQ(drive.last_error_code(), 0);
  enable();
  EXPECT_EQ(drive.axis_state(), AxisState::closed_loop_control);
  node.errors = error::missing_input;
  run(101ms);
  EXPECT_EQ(drive.last_error_code(), error_code(error::missing_input));
  EXPECT_EQ(drive.take_emergency(), error_code(error::missing_input));
  EXPECT_EQ(drive.take_emergency(), 0);
  EXPECT_EQ(Drive<float>::fault_text(drive.last_error_code()), fault_text(error_code(error::missing_input)));
  auto c = config;
  c.node_id = 63;
  EXPECT_EQ((Drive<float>{c, network, scale}.config_error()), DriveConfigError::node_id);
}

TEST_F(OdriveEdges, TakesNoFrameOfAnotherNode) {
  auto other = node;
  other.node_id = 6;
  other.turns = 3;
  deliver(other.heartbeat());
  deliver(other.estimates());
  drive.update(now);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_heartbeat);
  EXPECT_EQ(drive.position_counts(), 0);
}

TEST_F(OdriveEdges, TakesNoFrameWhileItIsUnusable) {
  auto c = config;
  c.max_torque_Nm = -1;
  drive = Drive<float>{c, network, scale};
  node.turns = 3;
  deliver(node.estimates());
  EXPECT_EQ(drive.position_counts(), 0);
  EXPECT_FALSE(drive.feedback().ever_valid);
}

TEST_F(OdriveEdges, OfLessThanANewtonIsUsed) {
  auto s = scale;
  s.max_force_N = 0.5F;
  drive = Drive<float>{config, network, s};
  enable();
  step(1);
  EXPECT_NEAR(*torque_Nm, 0.01F, 1.0F / 16384);
}

TEST_F(OdriveEdges, TwoSamplesAPeriodAreAConflictWhenTheyComeFiveTimesInARow) {
  set_up();
  for (int n = 0; n < 4; ++n) step_with(2);
  EXPECT_FALSE(drive.node_id_conflict());
  step_with(1);
  for (int n = 0; n < 4; ++n) step_with(3);
  EXPECT_FALSE(drive.node_id_conflict()) << "counted anew";
  step_with(2);
  EXPECT_TRUE(drive.node_id_conflict());
  for (int n = 0; n < 10; ++n) step_with(2);
  EXPECT_TRUE(drive.node_id_conflict()) << "as long as it lasts";
  step_with(1);
  EXPECT_FALSE(drive.node_id_conflict());
}

TEST_F(OdriveEdges, CountsDoubleSamplesFromTheFirstPeriodOn) {
  for (int n = 0; n < 4; ++n) step_with(2);
  EXPECT_FALSE(drive.node_id_conflict());
  step_with(2);
  EXPECT_TRUE(drive.node_id_conflict());
  drive = Drive<float>{config, network, scale};
  step_with(1);
  for (int n = 0; n < 4; ++n) step_with(2);
  EXPECT_FALSE(drive.node_id_conflict()) << "the first period had one";
}

// A drive that sends every 0.4 ms may be seen three times in a millisecond.
TEST_F(OdriveEdges, OneThatSendsFasterThanTheLoopIsNoConflict) {
  struct Row {
    hal::Duration each;
    int most;
  };
  for (const Row& row : {Row{500us, 2}, Row{400us, 3}, Row{1ms, 1}}) {
    auto c = config;
    c.estimate_period = row.each;
    drive = Drive<float>{c, network, scale};
    for (int n = 0; n < 10; ++n) step_with(row.most);
    EXPECT_FALSE(drive.node_id_conflict()) << row.most;
    for (int n = 0; n < 5; ++n) step_with(row.most + 1);
    EXPECT_TRUE(drive.node_id_conflict()) << row.most;
  }
}

TEST_F(PolledOdriveEdges, OneThatAnswersTwiceIsAConflict) {
  set_up();
  run(20ms);
  EXPECT_FALSE(drive.node_id_conflict());
  for (int n = 0; n < 5; ++n) {
    deliver(node.estimates());
    step();
  }
  EXPECT_TRUE(drive.node_id_conflict());
}

TEST_F(PolledOdriveEdges, IsAskedForItsEstimatesFirstAndForItsTorquesThen) {
  set_up();
  drive.update(now);
  hal::CanFrame frame;
  ASSERT_TRUE(drive.next_poll_frame(frame));
  EXPECT_EQ(frame, request_frame(5, Command::get_encoder_estimates));
  ASSERT_TRUE(drive.next_poll_frame(frame));
  EXPECT_EQ(frame, request_frame(5, Command::get_torques));
  EXPECT_FALSE(drive.next_poll_frame(frame));
}

TEST_F(PolledOdriveEdges, IsAskedNothingBeforeItIsHeard) {
  node.silent = true;
  run(50ms);
  EXPECT_EQ(questions, 0);
}

TEST_F(OdriveEdges, IsNeverPolledWhereItSendsByItself) {
  enable();
  EXPECT_EQ(questions, 0);
}

TEST_F(OdriveEdges, ReportsATorqueForThreePeriods) {
  set_up();
  node.torque_Nm = 0.04F;
  deliver(node.torques());
  drive.update(now + 3ms);
  EXPECT_FLOAT_EQ(drive.feedback().force_N, 2);
  drive.update(now + 3ms + 1ns);
  EXPECT_EQ(drive.feedback().force_N, 0);
}

// Up to a twentieth of the motor's torque may be noise.
TEST_F(OdriveEdges, IsSeenToGiveForceByATorqueBeyondATwentiethEitherWay) {
  set_up();
  const float noise_Nm = 1.0F / 20, beyond_Nm = std::nextafter(noise_Nm, 1.0F);
  for (const float sign : {1.0F, -1.0F}) {
    node.torque_Nm = sign * noise_Nm;
    step();
    EXPECT_EQ(feedback.state, DriveState::disabled);
    node.torque_Nm = sign * beyond_Nm;
    step();
    EXPECT_EQ(feedback.state, DriveState::stopping);
    node.torque_Nm = 0;
    run(300ms);
    EXPECT_EQ(feedback.state, DriveState::disabled);
  }
}

// Nobody has to ask for a command before there is one.
TEST_F(OdriveEdges, GivesNothingWhereNobodySaidAForce) {
  deliver(node.heartbeat());
  drive.update(now);
  hal::CanFrame frame;
  ASSERT_TRUE(drive.next_acyclic_frame(frame, now));
  deliver(node.version());
  ASSERT_TRUE(drive.next_acyclic_frame(frame, now));
  deliver(node.estimates());
  deliver(node.torques());
  drive.update(now);
  drive.request_enable();
  ASSERT_TRUE(drive.next_acyclic_frame(frame, now) && drive.next_acyclic_frame(frame, now));
  node.state = AxisState::closed_loop_control;
  deliver(node.heartbeat());
  drive.update(now);
  ASSERT_EQ(drive.feedback().state, DriveState::enabled);
  ASSERT_TRUE(drive.next_command_frame(frame));
  EXPECT_EQ(frame, torque_frame(5, 0));
}

TEST_F(OdriveEdges, CountsNoTravelToItsFirstSample) {
  node.turns = 2.5F;
  step();
  EXPECT_EQ(drive.position_counts(), 250000);
  EXPECT_EQ(feedback.travel_m, 0);
  node.turns = 2.0F;
  step();
  EXPECT_FLOAT_EQ(feedback.travel_m, -0.05F);
  step();
  EXPECT_EQ(feedback.travel_m, 0) << "since the feedback before";
}

TEST_F(OdriveEdges, StandsWhereItIsToldToAtOnceAndDoesNotTravelThere) {
  node.turns = 2;
  set_up();
  drive.set_reference_counts(17);
  EXPECT_EQ(drive.position_counts(), 17);
  drive.set_reference_counts(-300000);
  EXPECT_EQ(drive.position_counts(), -300000) << "of two, the newer";
  step();
  EXPECT_EQ(drive.position_counts(), -300000);
  EXPECT_EQ(feedback.travel_m, 0);
  node.turns = 3;
  step();
  EXPECT_EQ(drive.position_counts(), -200000);
  EXPECT_FLOAT_EQ(feedback.travel_m, 0.1F);
}

TEST_F(OdriveEdges, OfInvertedDirectionCountsTheOtherWayToTheCount) {
  auto c = config;
  c.invert_direction = true;
  drive = Drive<float>{c, network, scale};
  node.turns = 1;
  step();
  EXPECT_EQ(drive.position_counts(), -100000);
  node.turns = -2;
  step();
  EXPECT_EQ(drive.position_counts(), 200000);
}

TEST_F(OdriveEdges, WithoutAHomeStandsWhereItSays) {
  node.turns = 7;
  enable();
  EXPECT_EQ(drive.position_counts(), 700000);
}

TEST_F(OdriveEdges, WithAnAbsoluteEncoderNeedsNoHome) {
  auto c = with_home();
  c.absolute_encoder = true;
  drive = Drive<float>{c, network, scale};
  node.turns = 7;
  enable();
  EXPECT_EQ(drive.position_counts(), 700000);
}

// An enabling that is refused is none: the axis may still be moved by hand.
TEST_F(OdriveEdges, IsAtHomeWhereItIsEnabledAndNotWhereThatWasRefused) {
  drive = Drive<float>{with_home(), network, scale};
  node.silent = true;
  run(10ms);
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), 0) << "it is not set up";
  node.silent = false;
  set_up();
  node.state = AxisState::closed_loop_control;  // by somebody else
  deliver(node.heartbeat());
  step();
  EXPECT_EQ(feedback.state, DriveState::stopping);
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), 0) << "it has force";
  run(300ms);
  node.turns = 3;
  step();
  ASSERT_EQ(feedback.state, DriveState::disabled);
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), 1234);
}

TEST_F(OdriveEdges, IsAtHomeOnceOnly) {
  drive = Drive<float>{with_home(), network, scale};
  enable();
  stop();
  node.turns = 2;
  step();
  drive.request_enable();
  run(300ms);
  EXPECT_EQ(drive.position_counts(), 201234);
}

TEST_F(OdriveEdges, ThatLostItsReferenceIsAtHomeAgainWhenItWasReset) {
  drive = Drive<float>{with_home(), network, scale};
  enable();
  node.silent = true;
  run(400ms);
  node.silent = false;
  node.turns = 5;
  run(600ms);
  ASSERT_TRUE(drive.reference_lost());
  drive.reset_fault();
  EXPECT_FALSE(drive.reference_lost());
  run(300ms);
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), 1234);
  stop();
  drive.reset_fault();
  run(300ms);
  node.turns = 6;
  step();
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), 101234) << "nothing was lost since";
}

TEST_F(OdriveEdges, ThatLostItsReferenceAndHasNoHomeDoesNotGetItByAReset) {
  enable();
  node.silent = true;
  run(400ms);
  node.silent = false;
  run(600ms);
  drive.reset_fault();
  EXPECT_TRUE(drive.reference_lost());
}

TEST_F(OdriveEdges, LosesTheReferenceThatItWasToldWhileItIsSetUpByAnotherReboot) {
  set_up();
  node.answers_version = false;
  for (int reboot = 0; reboot < 2; ++reboot) {
    node.silent = node.blind = true;
    run(300ms);
    node.silent = node.blind = false;
    run(200ms);
    EXPECT_TRUE(drive.reference_lost()) << reboot;
    drive.set_reference_counts(1000);
    run(200ms);
    EXPECT_FALSE(drive.reference_lost()) << reboot;
    EXPECT_EQ(drive.setup_status(), SetupStatus::no_version);
  }
}

// What it has shown before a reboot says nothing of where it stands since.
TEST_F(OdriveEdges, ForgetsItsSampleWhenItReboots) {
  enable();
  node.torque_Nm = 0.04F;
  step();
  deliver(node.estimates());
  deliver(node.torques());
  node.state = AxisState::undefined;
  deliver(node.heartbeat());
  drive.update(now);
  feedback = drive.feedback();
  EXPECT_FALSE(feedback.fresh);
  EXPECT_FALSE(feedback.ever_valid);
  EXPECT_EQ(feedback.force_N, 0);
  node.turns = 30;
  step();
  EXPECT_TRUE(feedback.fresh && feedback.ever_valid);
  EXPECT_EQ(feedback.travel_m, 0);
}

TEST_F(OdriveEdges, IsNotEnabledBeforeItsPositionWasSeen) {
  node.turns = std::numeric_limits<float>::quiet_NaN();
  run(300ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
  node.blind = true;
  drive.reset_fault();
  run(5ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_FALSE(feedback.ever_valid);
  drive.request_enable();
  run(5ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(node.state, AxisState::idle);
}

}  // namespace
}  // namespace breakaway::odrive::test
