#include "breakaway/odrive/messages.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace breakaway::odrive
