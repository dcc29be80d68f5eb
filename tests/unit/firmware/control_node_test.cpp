#include "breakaway/firmware/control_node.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <vector>

#include "../explained_enum.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;

struct TestPort {
  std::vector<hal::CanFrame> sent;
  std::deque<hal::ReceivedFrame> inbox;
  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time) noexcept {
    sent.push_back(frame);
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (inbox.empty()) return false;
    received = inbox.front();
    inbox.pop_front();
    return true;
  }
  void purge_transmit_queue() noexcept {}
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }
};

// Notes what a RemoteAxis asks of it.
struct LoopProbe {
  std::vector<std::int32_t> targets;
  int enables = 0, stops = 0, resets = 0;
  void set_target_counts(std::size_t, std::int32_t counts) { targets.push_back(counts); }
  void request_enable(std::size_t) { ++enables; }
  void request_stop(std::size_t) { ++stops; }
  void reset_fault(std::size_t) { ++resets; }
};

constexpr std::uint8_t node = 0x7F;

TEST(RemoteControl, BringsCommandsBack) {
  for (const std::int32_t target : {0, 1, -1, 2147483647, -2147483647 - 1}) {
    const MotionCommand sent{.axis = 3, .enable = true, .reset_fault = target < 0, .target_counts = target};
    const auto received = decode_command(encode_command(sent, node), node);
    ASSERT_TRUE(received.has_value());
    EXPECT_EQ(received->axis, 3);
    EXPECT_TRUE(received->enable);
    EXPECT_EQ(received->reset_fault, target < 0);
    EXPECT_EQ(received->target_counts, target);
  }
}

TEST(RemoteControl, TakesNothingElseForACommand) {
  hal::CanFrame frame = encode_command({.enable = true}, node);
  EXPECT_FALSE(decode_command(frame, node - 1));
  frame.size = 7;
  EXPECT_FALSE(decode_command(frame, node));
  frame.size = 8;
  frame.remote = true;
  EXPECT_FALSE(decode_command(frame, node));
}

TEST(RemoteControl, KeepsCommandsFromTheLoopAndPassesTheRestOn) {
  TestPort port;
  CommandedPort<TestPort, 1> commanded{port, node};
  port.inbox = {{encode_command({.target_counts = 1}, node)},
                {{.id = canopen::tpdo_cob_id(1, 1)}},
                {encode_command({.axis = 9, .target_counts = 3}, node)},
                {encode_command({.target_counts = 2}, node)}};
  hal::ReceivedFrame received;
  ASSERT_TRUE(commanded.receive(received));
  EXPECT_EQ(received.frame.id, canopen::tpdo_cob_id(1, 1));
  EXPECT_FALSE(commanded.receive(received));
  EXPECT_EQ(commanded.take_command(0)->target_counts, 2) << "the newest";
  EXPECT_FALSE(commanded.take_command(0).has_value()) << "once";
}

TEST(RemoteControl, ActsOnChangesAndStopsWheneverToldSo) {
  LoopProbe loop;
  RemoteAxis axis;
  axis.apply(loop, {.enable = true, .reset_fault = true, .target_counts = 5});
  axis.apply(loop, {.enable = true, .reset_fault = true, .target_counts = 5});
  EXPECT_EQ(loop.targets, std::vector<std::int32_t>{5});
  EXPECT_EQ(loop.enables, 1);
  EXPECT_EQ(loop.resets, 1);
  EXPECT_EQ(loop.stops, 0);
  axis.apply(loop, {});
  axis.apply(loop, {});
  EXPECT_EQ(loop.stops, 2);
}

TEST(NodeError, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<NodeError>({{NodeError::none, {"can run"}},
                                     {NodeError::no_axis, {"axis is null", "give the node"}},
                                     {NodeError::axis_refused, {"axis is refused", "law::verify()"}},
                                     {NodeError::drive_refused, {"drive's configuration", "cia402::check()"}},
                                     {NodeError::period_differs, {"loop.period", "change one of them"}},
                                     {NodeError::bus_refused, {"does not fit the bus", "check_bus_budget()"}}});
}

class ControlNodeTest : public testing::Test {
 protected:
  ControlNodeTest() {
    config.drive.force_per_torque_N_per_Nm = 50;
    config.loop.period = 1ms;
    axis.parameters = {1, 400, 32, 60, {2.5F, 4.5F}, 50, 5, 2e-6F, 1e-6F, 1e-3F};
    axis.limits = {true, 2.5F, 4.5F, 50, 1e-3F, 2e-6F};
    axis.checksum = law::checksum_of(axis);
    config.axis = &axis;
  }
  ControlNode<TestPort> node_of_config() { return ControlNode<TestPort>{port, config}; }
  NodeError error() { return node_of_config().error(); }

  TestPort port;
  law::FlashedAxis<float> axis;
  NodeConfig<float> config;
};

TEST_F(ControlNodeTest, AcceptsAConfigurationThatAgreesWithItself) { EXPECT_EQ(error(), NodeError::none); }

TEST_F(ControlNodeTest, RefusesAnAxisThatIsDamagedOrNotCertifiedLikeThis) {
  axis.k3_table.nodes[7].value += 1;
  EXPECT_EQ(error(), NodeError::axis_refused);
  EXPECT_EQ(node_of_config().axis_error(), law::FlashedAxisError::checksum_differs);
  axis.limits.friction_upper_N = 4;
  axis.checksum = law::checksum_of(axis);
  EXPECT_EQ(error(), NodeError::axis_refused);
  EXPECT_EQ(node_of_config().axis_error(), law::FlashedAxisError::friction_outside_certificate);
}

TEST_F(ControlNodeTest, RefusesAnAxisThatIsMissingOrOfAnotherPeriod) {
  config.loop.period = 2ms;
  EXPECT_EQ(error(), NodeError::period_differs);
  config.axis = nullptr;
  EXPECT_EQ(error(), NodeError::no_axis);
}

TEST_F(ControlNodeTest, RefusesADriveThatTheDriveRefuses) {
  config.drive.node_id = 0;
  EXPECT_EQ(error(), NodeError::drive_refused);
  EXPECT_EQ(node_of_config().drive_error(), cia402::DriveConfigError::node_id);
}

TEST_F(ControlNodeTest, RefusesARateThatDoesNotFitTheBus) {
  config.loop.bit_rate = 125'000;
  EXPECT_EQ(error(), NodeError::bus_refused);
  EXPECT_EQ(node_of_config().bus_fit(), canopen::BusFit::overloaded);
}

TEST_F(ControlNodeTest, IsSilentWhenRefused) {
  config.drive.force_per_torque_N_per_Nm = 0;
  ControlNode<TestPort> refused{port, config};
  refused.step(hal::Time{1ms});
  EXPECT_TRUE(port.sent.empty());
}

TEST_F(ControlNodeTest, TellsItsStatusEveryFiftyPeriods) {
  ControlNode<TestPort> running{port, config};
  for (int i = 1; i <= 100; ++i) running.step(hal::Time{i * 1ms});
  int told = 0;
  for (const auto& frame : port.sent) told += frame.id == canopen::tpdo_cob_id(1, node) && frame.size == 8 ? 1 : 0;
  EXPECT_EQ(told, 2);
}

}  // namespace
}  // namespace breakaway::firmware
