#include "breakaway/odrive/messages.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>

#include "breakaway/odrive/master.hpp"

namespace breakaway::odrive {
namespace {

TEST(Messages, HaveTheNodeInTheUpperSixBitsOfTheIdentifier) {
  EXPECT_EQ(identifier(1, Command::set_input_position), 0x2C);
  EXPECT_EQ(identifier(62, Command::get_torques), 0x7DC);
  EXPECT_EQ(node_id_of(0x7DC), 62);
  EXPECT_EQ(command_of(0x7DC), Command::get_torques);
}

TEST(Messages, CarryLittleEndianFloatsAndNumbers) {
  const auto torque = torque_frame(1, 0.25F);
  EXPECT_EQ(torque.id, 0x2E);
  EXPECT_EQ(torque.size, 8);
  EXPECT_EQ(torque.data, (std::array<std::uint8_t, 8>{0, 0, 0x80, 0x3E, 0, 0, 0, 0}));
  EXPECT_EQ(torque_mode_frame(1).data, (std::array<std::uint8_t, 8>{1, 0, 0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(axis_state_frame(1, AxisState::closed_loop_control).data[0], 8);
  EXPECT_EQ(load_float(limits_frame(1, 20, 7.5F), 4), 7.5F);
  EXPECT_EQ(estop_frame(3).id, 0x62);
  EXPECT_EQ(clear_errors_frame(3).id, 0x78);
}

TEST(Messages, AreAsLongAsTheProtocolSaysAndEmptyBesideTheirValues) {
  EXPECT_EQ(axis_state_frame(1, AxisState::idle).data, (std::array<std::uint8_t, 8>{1, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(estop_frame(3).size, 0);
  EXPECT_EQ(clear_errors_frame(3).size, 1);
  EXPECT_EQ(clear_errors_frame(3).data[0], 0) << "identify";
  for (const auto& frame : {axis_state_frame(1, AxisState::idle), limits_frame(1, 20, 7.5F), torque_mode_frame(1)}) {
    EXPECT_EQ(frame.size, 8);
    EXPECT_FALSE(frame.remote);
  }
  EXPECT_FALSE(estop_frame(3).remote || clear_errors_frame(3).remote);
  EXPECT_EQ(request_frame(1, Command::get_error).size, 8);
}

TEST(Messages, ReadWhatADriveReports) {
  const std::array<std::uint8_t, 8> data{1, 2, 3, 4, 5, 6, 7, 8};
  const auto frame_for = [&](Command command) {
    return hal::CanFrame{.id = identifier(1, command), .size = 8, .data = data};
  };
  const auto version = as_version(frame_for(Command::get_version));
  ASSERT_TRUE(version);
  EXPECT_EQ(version->major, 5);
  EXPECT_EQ(version->minor, 6);
  const auto errors = as_errors(frame_for(Command::get_error));
  ASSERT_TRUE(errors);
  EXPECT_EQ(errors->active, 0x04030201U);
  EXPECT_EQ(errors->disarm_reason, 0x08070605U);
  const auto first = std::bit_cast<float>(0x04030201U), second = std::bit_cast<float>(0x08070605U);
  const auto estimates = as_estimates(frame_for(Command::get_encoder_estimates));
  ASSERT_TRUE(estimates);
  EXPECT_EQ(estimates->first, first);
  EXPECT_EQ(estimates->second, second);
  const auto torques = as_torques(frame_for(Command::get_torques));
  ASSERT_TRUE(torques);
  EXPECT_EQ(torques->first, first);
  EXPECT_EQ(torques->second, second);
}

TEST(Messages, OfNothingAreEmpty) {
  const Heartbeat heartbeat;
  EXPECT_EQ(heartbeat.errors, 0U);
  EXPECT_EQ(heartbeat.state, AxisState::undefined);
  EXPECT_EQ(heartbeat.procedure_result, 0);
  const Version version;
  EXPECT_TRUE(version.major == 0 && version.minor == 0);
  const Errors errors;
  EXPECT_TRUE(errors.active == 0 && errors.disarm_reason == 0);
  const FloatPair pair;
  EXPECT_TRUE(pair.first == 0 && pair.second == 0);
}

TEST(Messages, AskByRemoteFrames) {
  const auto asked = request_frame(2, Command::get_encoder_estimates);
  EXPECT_TRUE(asked.remote);
  EXPECT_EQ(asked.id, 0x49);
  EXPECT_FALSE(as_estimates(asked));
}

TEST(Messages, ReadAHeartbeat) {
  const hal::CanFrame frame{.id = 0x21, .size = 8, .data = {0, 0, 0, 1, 8, 3, 0, 0}};
  const auto heartbeat = as_heartbeat(frame);
  ASSERT_TRUE(heartbeat);
  EXPECT_EQ(heartbeat->errors, 1U << 24U);
  EXPECT_EQ(heartbeat->state, AxisState::closed_loop_control);
  EXPECT_EQ(heartbeat->procedure_result, 3);
}

TEST(Messages, OfAnotherKindOrTooShortAreNotRead) {
  hal::CanFrame frame{.id = 0x21, .size = 7};
  EXPECT_FALSE(as_heartbeat(frame));
  frame.size = 8;
  EXPECT_TRUE(as_heartbeat(frame));
  EXPECT_FALSE(as_version(frame));
  EXPECT_FALSE(as_errors(frame));
  EXPECT_FALSE(as_torques(frame));
}

TEST(Master, TellsCommandsOfAnotherFromQuestionsAndAnswers) {
  EXPECT_TRUE(Master::is_command(axis_state_frame(4, AxisState::idle), 4));
  EXPECT_TRUE(Master::is_command(torque_frame(4, 1), 4));
  EXPECT_TRUE(Master::is_command(torque_mode_frame(4), 4));
  EXPECT_TRUE(Master::is_command(clear_errors_frame(4), 4));
  EXPECT_FALSE(Master::is_command(torque_frame(4, 1), 5));
  EXPECT_FALSE(Master::is_command(estop_frame(4), 4)) << "the drive names it by itself";
  EXPECT_FALSE(Master::is_command(request_frame(4, Command::get_torques), 4));
  for (const unsigned answer : {0x00U, 0x01U, 0x03U, 0x05U, 0x06U, 0x09U, 0x14U, 0x15U, 0x17U, 0x1CU, 0x1DU})
    EXPECT_FALSE(Master::is_command({.id = static_cast<std::uint16_t>(4U << 5U | answer), .size = 8}, 4)) << answer;
}

// 0x0B to 0x13 and 0x16 to 0x1B set or move something; 0x17 is the drive's report of its supply.
TEST(Master, TakesTheWholeRangeOfWhatMovesADrive) {
  const auto is_command = [](unsigned command) {
    return Master::is_command({.id = static_cast<std::uint16_t>(4U << command_bits | command), .size = 8}, 4);
  };
  for (const unsigned command : {0x07U, 0x0BU, 0x0EU, 0x13U, 0x16U, 0x18U, 0x1BU}) EXPECT_TRUE(is_command(command));
  for (const unsigned command : {0x08U, 0x0AU, 0x14U, 0x15U, 0x17U, 0x1CU, 0x1FU}) EXPECT_FALSE(is_command(command));
}

TEST(Master, TellsTheWriteOfAParameterFromTheQuestionForOne) {
  hal::CanFrame frame{.id = identifier(4, Command::write_parameter), .size = 8};
  EXPECT_FALSE(Master::is_command(frame, 4)) << "opcode 0 reads";
  frame.data[1] = 7;
  EXPECT_FALSE(Master::is_command(frame, 4)) << "of which endpoint is all the same";
  frame.data[0] = 1;
  EXPECT_TRUE(Master::is_command(frame, 4));
}

TEST(Master, HasNothingOfItsOwnOnTheBus) {
  Master master{hal::NetworkConfig{}};
  hal::CanFrame frame = torque_frame(62, 1);
  EXPECT_EQ(Master::node_of(frame), 62);
  EXPECT_FALSE(Master::is_own(frame));
  EXPECT_FALSE(master.next_sync(frame));
  EXPECT_FALSE(master.next_heartbeat(frame, {}));
}

}  // namespace
}  // namespace breakaway::odrive
