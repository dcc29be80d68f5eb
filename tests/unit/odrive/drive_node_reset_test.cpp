// Why a node left closed loop control, its faults, and how it is reset: what is asked and told once.
#include "drive_node_fixture.hpp"

namespace breakaway::odrive::test {
namespace {

class OdriveNodeReset : public NodeTest {};

TEST_F(OdriveNodeReset, ThatLeftByItselfIsAskedWhyForFivePeriodsAndThenStopped) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  for (int period = 0; period < 5; ++period) {
    EXPECT_TRUE(node.wished()) << period;
    EXPECT_EQ(next(), ask_errors) << period;
    EXPECT_EQ(next(), ask_errors) << "as often as there is room";
    update_after(1ms);
  }
  EXPECT_FALSE(node.wished());
  EXPECT_FALSE(next());
  EXPECT_EQ(node.code(), 0);
}

TEST_F(OdriveNodeReset, TakesTheReasonOfADisarmingWhileItAsksOnly) {
  make_follow();
  errors(0, error::estop_requested);
  EXPECT_EQ(node.code(), 0) << "it may be from before";
  heartbeat(AxisState::idle);
  update_after(1ms);
  errors(error::initializing, error::initializing);
  EXPECT_EQ(node.code(), 0) << "no reason";
  EXPECT_TRUE(node.wished());
  errors(0, error::estop_requested);
  EXPECT_EQ(node.code(), error_code(error::estop_requested));
  EXPECT_FALSE(node.wished());
  EXPECT_FALSE(next()) << "it is asked no more";
  errors(0, error::missing_input);
  EXPECT_EQ(node.code(), error_code(error::estop_requested)) << "the first is kept";
}

TEST_F(OdriveNodeReset, TakesAnActiveErrorForAReasonToo) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  errors(error::missing_input, 0);
  EXPECT_EQ(node.code(), error_code(error::missing_input));
}

TEST_F(OdriveNodeReset, ThatIsBackInClosedLoopControlIsAskedNoMore) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_EQ(next(), ask_errors);
  heartbeat(AxisState::closed_loop_control);
  update_after(1ms);
  EXPECT_FALSE(next());
  EXPECT_TRUE(node.follows());
  heartbeat(AxisState::idle);
  update_after(1ms);
  for (int period = 0; period < 5; ++period, update_after(1ms)) EXPECT_TRUE(node.wished()) << period;
  EXPECT_FALSE(node.wished());
}

TEST_F(OdriveNodeReset, NamesTheFirstFaultOfItsOwnAndTellsItOnce) {
  make_follow();
  node.fail(OwnFault::position_too_coarse);
  node.fail(OwnFault::torque_not_a_number);
  EXPECT_FALSE(node.wished());
  EXPECT_EQ(node.code(), static_cast<std::uint16_t>(OwnFault::position_too_coarse));
  EXPECT_EQ(node.take_new_code(), static_cast<std::uint16_t>(OwnFault::position_too_coarse));
  node.fail(OwnFault::position_too_coarse);
  EXPECT_EQ(node.take_new_code(), 0) << "it is still the same";
  EXPECT_EQ(next(), idle) << "at once";
}

TEST_F(OdriveNodeReset, IsToldToClearOnceAndItsModeAnewWhenItIsReset) {
  make_ready();
  node.fail(OwnFault::position_too_coarse);
  node.reset_fault();
  EXPECT_NE(node.code(), 0) << "a period takes it up";
  update_after(1ms);
  EXPECT_EQ(node.code(), 0);
  EXPECT_EQ(node.take_new_code(), 0) << "it was reset before it was told";
  EXPECT_EQ(next(), clear_errors_frame(asked_node));
  EXPECT_EQ(next(), mode);
  EXPECT_FALSE(next());
  node.on_estimate(now);
  update_after(1ms);
  EXPECT_TRUE(node.ready());
  EXPECT_FALSE(next());
}

TEST_F(OdriveNodeReset, ThatIsLostIsNotAnyMoreWhenItIsReset) {
  make_ready();
  update_after(251ms);
  ASSERT_TRUE(node.heartbeat_lost());
  node.reset_fault();
  update_after(1ms);
  EXPECT_FALSE(node.heartbeat_lost());
}

// What is told to a drive without power, or behind a cable that is out, nobody hears.
TEST_F(OdriveNodeReset, ThatIsNotHeardWhenItIsResetIsToldToClearAsSoonAsItIs) {
  make_ready();
  update_after(251ms);
  ASSERT_FALSE(node.heard());
  node.reset_fault();
  update_after(1ms);
  EXPECT_FALSE(next());
  heartbeat(AxisState::undefined, error::missing_input);
  EXPECT_FALSE(next()) << "it still starts";
  heartbeat(AxisState::idle, error::missing_input);
  EXPECT_EQ(next(), clear_errors_frame(asked_node));
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version));
}

TEST_F(OdriveNodeReset, OfOldFirmwareIsAskedAgainWhenItIsReset) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version));
  version(0, 5);
  node.reset_fault();
  update_after(1ms);
  EXPECT_FALSE(node.refused());
  heartbeat(AxisState::idle);
  EXPECT_EQ(next(), clear_errors_frame(asked_node));
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version)) << "its update may have come";
}

TEST_F(OdriveNodeReset, ThatIsEnabledHasNothingToReset) {
  make_follow();
  node.reset_fault();
  update_after(1ms);
  EXPECT_TRUE(node.follows());
  EXPECT_FALSE(next());
  make_ready();
  node.request_enable();
  node.reset_fault();
  update_after(1ms);
  EXPECT_TRUE(node.wished());
  EXPECT_EQ(next(), mode);
}

TEST_F(OdriveNodeReset, TakesTheReasonOfADisarmingToTheLastPeriod) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  for (int period = 1; period < 5; ++period) update_after(1ms);
  ASSERT_TRUE(node.wished());
  errors(0, error::estop_requested);
  EXPECT_EQ(node.code(), error_code(error::estop_requested));
}

TEST_F(OdriveNodeReset, ThatStartsAgainIsNotWishedEnabledAnyMore) {
  make_follow();
  heartbeat(AxisState::undefined);
  EXPECT_FALSE(node.wished());
  EXPECT_TRUE(node.take_reboot());
}

// What the drive says next counts again.
TEST_F(OdriveNodeReset, ThatIsResetHasNoErrorUntilItsNextHeartbeat) {
  make_ready();
  heartbeat(AxisState::idle, error::missing_input);
  update_after(1ms);
  ASSERT_EQ(node.code(), error_code(error::missing_input));
  node.reset_fault();
  update_after(1ms);
  EXPECT_EQ(node.code(), 0);
  heartbeat(AxisState::idle, error::missing_input);
  EXPECT_EQ(node.code(), error_code(error::missing_input));
}

}  // namespace
}  // namespace breakaway::odrive::test
