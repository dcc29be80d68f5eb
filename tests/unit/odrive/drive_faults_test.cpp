#include <random>

#include "breakaway/odrive/drive.hpp"
#include "obedient_node.hpp"

namespace breakaway::odrive::test {
namespace {

using hal::DriveState;

class OdriveFaults : public DriveTest {
 protected:
  // Steps until something is told, and returns it.
  std::uint16_t next_emergency(hal::Duration most) {
    for (const hal::Time end = now + most; now < end;) {
      step(10);
      if (const auto code = drive.take_emergency(); code != 0) return code;
    }
    return 0;
  }
};

TEST_F(OdriveFaults, AnErrorWhileEnabledIsNamedAndNeedsAReset) {
  enable();
  node.errors = error::watchdog_timer_expired;
  node.state = AxisState::idle;
  EXPECT_EQ(next_emergency(101ms), error_code(error::watchdog_timer_expired));
  run(200ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, error_code(error::watchdog_timer_expired));
  drive.request_enable();
  run(300ms);
  EXPECT_EQ(node.state, AxisState::idle);
  EXPECT_EQ(told(Command::clear_errors), 0);
  drive.reset_fault();
  node.told.clear();
  run(300ms);
  EXPECT_EQ(told(Command::clear_errors), 1);
  EXPECT_EQ(told(Command::set_controller_mode), 1) << "what brought the fault may have changed it";
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveFaults, AnErrorOfADriveThatStaysEnabledStopsIt) {
  enable();
  node.errors = 1U << 28U;
  EXPECT_EQ(next_emergency(101ms), error_code(1U << 28U));
  run(2ms);
  EXPECT_EQ(node.state, AxisState::idle);
}

TEST_F(OdriveFaults, AReasonThatOnlyGetErrorTellsIsAskedFor) {
  enable();
  node.disarm_reason = error::estop_requested;
  node.state = AxisState::idle;
  EXPECT_EQ(next_emergency(110ms), error_code(error::estop_requested));
  run(100ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
}

TEST_F(OdriveFaults, LeavingWithoutAReasonIsSeenAndNotUndone) {
  enable();
  node.state = AxisState::idle;
  run(120ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  run(500ms);
  EXPECT_EQ(node.state, AxisState::idle);
}

TEST_F(OdriveFaults, ARefusalToEnableIsNamed) {
  set_up();
  node.enables = false;
  node.result = 14;
  drive.request_enable();
  run(2s);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, procedure_code(14));
}

TEST_F(OdriveFaults, ADriveThatDoesNotSayWhyItIsNotEnabledIsToldFurther) {
  set_up();
  node.enables = false;
  drive.request_enable();
  run(2s);
  EXPECT_EQ(feedback.state, DriveState::enabling);
  EXPECT_EQ(feedback.fault_code, 0);
  node.enables = true;
  run(500ms);
  EXPECT_EQ(feedback.state, DriveState::enabled);
}

TEST_F(OdriveFaults, ADriveThatStartsForEverIsNamedAndReset) {
  node.errors = error::initializing;
  run(2s);
  EXPECT_EQ(drive.setup_status(), SetupStatus::starting);
  run(2s);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, error_code(error::initializing));
  drive.reset_fault();
  run(500ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveFaults, AResultFromBeforeIsNoRefusal) {
  node.result = 3;
  enable();
}

TEST_F(OdriveFaults, AStopThatIsNotObeyedIsForcedByEstop) {
  enable();
  node.deaf_to_idle = true;
  drive.request_stop();
  run(110ms);
  EXPECT_FALSE(feedback.stop_not_obeyed) << "a heartbeat may be so late";
  EXPECT_EQ(told(Command::estop), 0);
  run(80ms);
  EXPECT_EQ(told(Command::estop), 1);
  EXPECT_EQ(node.state, AxisState::idle);
  node.told.clear();
  run(400ms);
  EXPECT_FALSE(feedback.stop_not_obeyed);
  EXPECT_EQ(told(Command::set_controller_mode), 1) << "it is set up anew";
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, error_code(error::estop_requested));
}

TEST_F(OdriveFaults, ADriveThatObeysNothingIsToldForEver) {
  enable();
  node.deaf = true;
  drive.request_stop();
  run(5s, 20);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  EXPECT_GT(told(Command::estop), 50);
  EXPECT_EQ(torque_Nm, 0.0F);
  drive.reset_fault();
  drive.request_enable();
  run(1s, 20);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  EXPECT_EQ(torque_Nm, 0.0F);
  node.deaf = false;
  run(1s);
  EXPECT_EQ(told(Command::clear_errors), 0) << "what was asked for while it had force is forgotten";
}

TEST_F(OdriveFaults, IdleIsNotBelievedWhileTorqueIsReported) {
  enable();
  drive.request_stop();
  node.torque_Nm = 0.5F;
  run(300ms);
  EXPECT_EQ(node.state, AxisState::idle);
  EXPECT_TRUE(feedback.stop_not_obeyed);
  node.torque_Nm = 0;
  run(400ms);
  EXPECT_FALSE(feedback.stop_not_obeyed);
}

TEST_F(OdriveFaults, SilenceIsALossAndLosesTheReference) {
  enable();
  node.silent = true;
  run(349ms);
  EXPECT_TRUE(drive.heartbeat_lost());
  EXPECT_TRUE(drive.reference_lost());
  EXPECT_NE(feedback.state, DriveState::enabled);
  EXPECT_EQ(torque_Nm, 0.0F);
  node.silent = false;
  run(600ms);
  EXPECT_FALSE(drive.heartbeat_lost());
  EXPECT_EQ(feedback.state, DriveState::disabled) << "set up anew, and not enabled by itself";
  EXPECT_TRUE(drive.reference_lost());
  drive.set_reference_counts(17);
  EXPECT_FALSE(drive.reference_lost());
}

TEST_F(OdriveFaults, ARebootThatIsHeardLosesTheReference) {
  enable();
  node.state = AxisState::idle;
  node.errors = error::initializing;
  run(101ms);
  EXPECT_TRUE(drive.reference_lost());
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(torque_Nm.value_or(0), 0.0F);
  node.errors = 0;
  node.told.clear();
  run(400ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(told(Command::set_controller_mode), 1) << "its mode was lost";
}

// A heartbeat may lie, and a drive without a watchdog goes on with the torque that it was told last.
TEST_F(OdriveFaults, ADriveThatShowsAStartWhileItRunsIsToldATorqueOfZero) {
  enable();
  run(5ms, 2);
  ASSERT_GT(node.last_torque_Nm, 0);
  node.deaf_to_idle = true;
  auto lie = node.heartbeat();
  lie.data[4] = static_cast<std::uint8_t>(AxisState::undefined);
  deliver(lie);
  step(2);
  EXPECT_EQ(node.last_torque_Nm, 0);
  EXPECT_EQ(torque_Nm, 0.0F) << "and its watchdog is fed, because it may be set up next";
}

TEST_F(OdriveFaults, AnAbsoluteEncoderKeepsItsReference) {
  auto c = config;
  c.absolute_encoder = true;
  drive = Drive<float>{c, network, scale};
  enable();
  node.silent = true;
  run(400ms);
  EXPECT_FALSE(drive.reference_lost());
}

TEST_F(OdriveFaults, APositionThatIsNoNumberStopsTheDriveAndIsNamed) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    node = {};
    drive = Drive<float>{config, network, scale};
    node.turns = 1;
    enable();
    node.turns = bad;
    EXPECT_EQ(next_emergency(3ms), static_cast<std::uint16_t>(OwnFault::position_not_a_number));
    EXPECT_FALSE(feedback.fresh);
    EXPECT_TRUE(std::isfinite(feedback.position_m) && std::isfinite(feedback.position_offset_m));
    run(2ms);
    EXPECT_EQ(node.state, AxisState::idle);
    node.turns = 1;
    run(300ms);
    EXPECT_EQ(feedback.state, DriveState::fault);
    drive.request_enable();
    run(300ms);
    EXPECT_EQ(feedback.state, DriveState::fault) << "it was not acknowledged";
    EXPECT_EQ(node.state, AxisState::idle);
    drive.reset_fault();
    run(300ms);
    EXPECT_EQ(feedback.state, DriveState::disabled);
  }
}

TEST_F(OdriveFaults, APositionThatIsCoarserThanACountIsNamed) {
  enable();
  node.turns = 129;
  EXPECT_EQ(next_emergency(3ms), static_cast<std::uint16_t>(OwnFault::position_too_coarse));
  run(300ms);
  drive.reset_fault();
  run(300ms);
  EXPECT_EQ(feedback.state, DriveState::fault) << "its cause is still there";
}

TEST_F(OdriveFaults, ATorqueThatIsNoNumberIsNamed) {
  enable();
  node.torque_Nm = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(next_emergency(3ms), static_cast<std::uint16_t>(OwnFault::torque_not_a_number));
  EXPECT_TRUE(std::isfinite(feedback.force_N));
}

TEST_F(OdriveFaults, ATorqueWhoseForceIsNoNumberIsNamed) {
  enable();
  node.torque_Nm = 3e38F;
  EXPECT_EQ(next_emergency(3ms), static_cast<std::uint16_t>(OwnFault::torque_not_a_number));
  EXPECT_TRUE(std::isfinite(feedback.force_N));
}

// Without its reports nothing shows that the axis does not move under its force, or gets another than it was told.
TEST_F(OdriveFaults, ADriveThatTellsItsPositionAndNoTorqueIsStoppedAndNamed) {
  enable();
  node.mute = true;
  run(10ms, 10);
  EXPECT_EQ(feedback.state, DriveState::enabled) << "reports may be lost now and then";
  EXPECT_EQ(next_emergency(1ms), static_cast<std::uint16_t>(OwnFault::torque_not_reported));
  EXPECT_EQ(torque_Nm, 0.0F);
  run(200ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
  node.mute = false;
  drive.reset_fault();
  run(200ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(OdriveFaults, ADriveThatNeverTellsItsTorqueGivesNone) {
  node.mute = true;
  set_up();
  drive.request_enable();
  for (int period = 0; period < 300; ++period) {
    step(10);
    EXPECT_NE(feedback.state, DriveState::enabled);
    EXPECT_EQ(node.last_torque_Nm, 0);
  }
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, static_cast<std::uint16_t>(OwnFault::torque_not_reported));
}

// Its position is named first, which is what the axis lacks most.
TEST_F(OdriveFaults, ADriveThatTellsNeitherPositionNorTorqueHasNoFaultOfItsOwn) {
  enable();
  node.blind = true;
  EXPECT_EQ(next_emergency(200ms), 0);
}

TEST_F(OdriveFaults, TwoNodesOfOneIdAreNoticed) {
  enable();
  run(50ms);
  EXPECT_FALSE(drive.node_id_conflict());
  for (int i = 0; i < 10; ++i) {
    deliver(node.estimates());
    step();
  }
  EXPECT_TRUE(drive.node_id_conflict());
}

TEST_F(OdriveFaults, LateEstimatesAreNoConflict) {
  enable();
  for (int i = 0; i < 40; ++i) {
    node.blind = i % 2 == 0;
    if (i % 2 == 1) deliver(node.estimates());
    step();
    EXPECT_FALSE(drive.node_id_conflict());
  }
}

// Whatever the bits are, no number that is not one comes out, the torque stays inside its limit, and nothing but zero
// is sent while the drive is not enabled.
TEST_F(OdriveFaults, RandomBitsInEveryMessageKeepTheTorqueBounded) {
  std::mt19937 random{20261123};
  std::uniform_int_distribution<unsigned> byte{0, 255}, command{0, 31}, seldom{0, 40}, request{0, 60};
  long enabled = 0;
  for (int i = 0; i < 300000; ++i) {
    if (seldom(random) == 0) {
      hal::CanFrame frame{.id = static_cast<std::uint16_t>(5U << 5U | command(random)), .size = 8};
      for (auto& b : frame.data) b = static_cast<std::uint8_t>(byte(random));
      if (seldom(random) == 0) frame.size = static_cast<std::uint8_t>(byte(random));
      deliver(frame);
    }
    switch (request(random)) {
      case 0:
        drive.request_stop();
        break;
      case 1:
      case 2:
        drive.request_enable();
        break;
      case 3:
      case 4:
        drive.reset_fault();
        break;
      case 5:
        drive.set_reference_counts(static_cast<std::int32_t>(random()));
        break;
      default:
        break;
    }
    step(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
    enabled += feedback.state == DriveState::enabled;
    const float torque = torque_Nm.value_or(0);
    ASSERT_TRUE(std::isfinite(torque) && std::abs(torque) * 50 <= 40 * (1 + 1e-6F)) << i;
    if (feedback.state != DriveState::enabled) {
      ASSERT_EQ(torque, 0) << i;
    }
    ASSERT_TRUE(std::isfinite(feedback.position_m) && std::isfinite(feedback.travel_m)) << i;
  }
  EXPECT_GT(enabled, 10000);
}

}  // namespace
}  // namespace breakaway::odrive::test
