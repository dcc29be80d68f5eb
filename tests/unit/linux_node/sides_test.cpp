// What a run of drives does otherwise for CANopen and for ODrives.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/emcy.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/odrive/fault_code.hpp"
#include "breakaway/odrive/messages.hpp"
#include "canopen_side.hpp"
#include "odrive_side.hpp"

namespace breakaway::linux_node::test {
namespace {

using odrive::Command;

constexpr hal::NetworkConfig network{.period = std::chrono::milliseconds{1}, .node_id = 100};
constexpr std::array<std::uint8_t, 2> nodes{1, 3};

hal::CanFrame with_id(std::uint16_t id) { return {.id = id, .size = 8, .remote = false, .data = {}}; }

TEST(CanopenSide, HearsAnotherMasterByItsSyncOrItsHeartbeat) {
  EXPECT_EQ(CanopenSide::other_master(canopen::sync_frame(), network, nodes), "it sends SYNC");
  EXPECT_EQ(CanopenSide::other_master(with_id(canopen::heartbeat_cob_id(100)), network, nodes),
            "it is node 100, as we are");
  EXPECT_EQ(CanopenSide::other_master(with_id(canopen::heartbeat_cob_id(1)), network, nodes), "");
  EXPECT_EQ(CanopenSide::other_master(with_id(canopen::rpdo_cob_id(1, 1)), network, nodes), "it commands node 1");
  EXPECT_EQ(CanopenSide::other_master(with_id(canopen::rpdo_cob_id(1, 2)), network, nodes), "");
  EXPECT_EQ(CanopenSide::other_master(with_id(canopen::sdo_request_cob_id(1)), network, nodes), "") << "it asks";
}

TEST(CanopenSide, HearsANodeByItsHeartbeatAndItsAnswers) {
  EXPECT_EQ(CanopenSide::heard_node(with_id(canopen::heartbeat_cob_id(9))), 9);
  EXPECT_EQ(CanopenSide::heard_node(with_id(canopen::sdo_response_cob_id(9))), 9);
  EXPECT_FALSE(CanopenSide::heard_node(with_id(canopen::tpdo_cob_id(1, 9))));
}

TEST(CanopenSide, SaysWhatErrorADriveToldAndNoInformation) {
  CanopenSide::Drive drive{
      {.node_id = 1, .force_per_torque_N_per_Nm = 50, .emcy_information = {.first = {0x4200}, .last = {0x42FF}}},
      network,
      {.encoder_resolution_m = 1e-6F, .max_force_N = 50}};
  const auto hear = [&](const canopen::Emcy& emcy) { drive.on_frame({.frame = canopen::emcy_frame(emcy, 1)}); };
  StepRecord step;
  hear({.code = 0x4210, .error_register = 0x08});
  CanopenSide::note(drive, step);
  EXPECT_EQ(step.error_register, 0);
  EXPECT_EQ(CanopenSide::why_standing(drive).find("tells why"), std::string::npos);
  hear({.code = 0x3110, .error_register = 0x05});
  hear({.code = 0x4210, .error_register = 0x0D});
  CanopenSide::note(drive, step);
  EXPECT_EQ(step.error_register, 0x05);
  EXPECT_NE(CanopenSide::why_standing(drive).find("error code 3110h"), std::string::npos)
      << CanopenSide::why_standing(drive);
}

TEST(OdriveSide, HearsAnotherMasterByACommandToOneOfItsDrives) {
  EXPECT_EQ(OdriveSide::other_master(odrive::torque_frame(3, 0), network, nodes), "it commands node 3");
  EXPECT_EQ(OdriveSide::other_master(odrive::axis_state_frame(1, odrive::AxisState::idle), network, nodes),
            "it commands node 1");
  EXPECT_EQ(OdriveSide::other_master(odrive::torque_frame(2, 0), network, nodes), "") << "of another bus' master";
  EXPECT_EQ(OdriveSide::other_master(odrive::request_frame(1, Command::get_error), network, nodes), "") << "it asks";
}

TEST(OdriveSide, HearsANodeByItsHeartbeat) {
  EXPECT_EQ(OdriveSide::heard_node(odrive::frame_of(0, Command::heartbeat, 0U, 1U)), 0);
  EXPECT_EQ(OdriveSide::heard_node(odrive::frame_of(62, Command::heartbeat, 0U, 1U)), 62);
  EXPECT_FALSE(OdriveSide::heard_node(odrive::frame_of(5, Command::get_torques, 0U, 1U)));
}

TEST(OdriveSide, SaysWhatACodeMeansAndWhyADriveStaysDisabled) {
  const OdriveSide::Drive drive{
      {.node_id = 1, .force_per_torque_N_per_Nm = 50, .max_torque_Nm = 1, .counts_per_turn = 1e5},
      network,
      {.encoder_resolution_m = 1e-6F, .max_force_N = 50}};
  StepRecord step{.fault_code = odrive::error_code(1U << 13U)};
  OdriveSide::note(drive, step);
  EXPECT_EQ(step.code_text, "the motor is too hot");
  EXPECT_EQ(step.setup_text, to_string(odrive::SetupStatus::no_heartbeat));
  EXPECT_FALSE(OdriveSide::was_heard(drive));
  EXPECT_EQ(OdriveSide::why_standing(drive), to_string(odrive::SetupStatus::no_heartbeat));
}

}  // namespace
}  // namespace breakaway::linux_node::test
