#include "breakaway/firmware/control_node.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <utility>
#include <vector>

#include "../cia402/scripted_drive.hpp"
#include "certified_node.hpp"
#include "listed_port.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;

// Notes what a RemoteAxis asks of it.
struct LoopProbe {
  std::vector<std::int32_t> targets;
  int enables = 0, stops = 0, resets = 0;
  std::vector<AxisFault> stopped_with;
  std::vector<std::int32_t> references;
  bool takes_resets = true;
  using AxisId = int;
  void set_target_counts(AxisId, std::int32_t counts) { targets.push_back(counts); }
  std::int32_t target_counts(AxisId) const { return targets.back(); }
  bool wanted = false;
  void request_enable(AxisId) {
    ++enables;
    wanted = true;
  }
  void request_stop(AxisId) {
    ++stops;
    wanted = false;
  }
  bool reset_fault(AxisId) {
    ++resets;
    return takes_resets;
  }
  void stop_with(AxisId, AxisFault fault, hal::Time) { stopped_with.push_back(fault); }
  bool set_reference_counts(AxisId, std::int32_t counts) {
    references.push_back(counts);
    return takes_resets;
  }
};

constexpr std::uint8_t node = 0x7F;

TEST(RemoteControl, BringsCommandsBack) {
  for (const std::int32_t target : {0, 1, -1, 2147483647, -2147483647 - 1}) {
    const MotionCommand sent{
        .axis = 3, .enable = true, .reset_fault = target<0, .reference = target> 0, .target_counts = target};
    const auto received = decode_command(encode_command(sent, node), node);
    ASSERT_TRUE(received.has_value());
    EXPECT_EQ(received->axis, 3);
    EXPECT_TRUE(received->enable);
    EXPECT_EQ(received->reset_fault, target < 0);
    EXPECT_EQ(received->reference, target > 0);
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
  ListedPort port;
  CommandedPort<ListedPort, 1> commanded{port, node};
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

TEST(RemoteControl, AStopIsHeardThoughTheSamePeriodBroughtMore) {
  for (const bool first : {false, true}) {
    for (const bool second : {false, true}) {
      for (const bool third : {false, true}) {
        ListedPort port;
        CommandedPort<ListedPort, 1> commanded{port, node};
        hal::ReceivedFrame received;
        for (const bool enable : {first, second, third})
          port.inbox.push_back({encode_command({.enable = enable}, node)});
        EXPECT_FALSE(commanded.receive(received));
        const auto command = commanded.take_command(0);
        ASSERT_TRUE(command);
        EXPECT_EQ(command->enable, third);
        EXPECT_EQ(command->stopped, !(first && second));
        port.inbox = {{encode_command({.enable = true}, node)}};
        EXPECT_FALSE(commanded.receive(received));
        EXPECT_FALSE(commanded.take_command(0)->stopped) << "that was said in an earlier period";
      }
    }
  }
}

TEST(RemoteControl, KeepsTheCommandsOfTwoAxesApart) {
  ListedPort port;
  CommandedPort<ListedPort, 2> commanded{port, node};
  port.inbox = {{encode_command({.axis = 1, .target_counts = 7}, node)},
                {encode_command({.axis = 0, .target_counts = -7}, node)},
                {encode_command({.axis = 2, .target_counts = 9}, node)}};
  hal::ReceivedFrame received;
  EXPECT_FALSE(commanded.receive(received));
  EXPECT_EQ(commanded.take_command(0)->target_counts, -7);
  EXPECT_EQ(commanded.take_command(1)->target_counts, 7);
}

TEST(ControlNode, SaysWhenTheSyncOfItsPeriodIsToLeave) {
  const FlashedNode<float, 2> flashed = testing::certified_node();
  ListedPort port;
  ControlNode<ListedPort, FlashedNode<float, 2>> controller{port, flashed};
  EXPECT_FALSE(controller.sync_due()) << "no period has begun";
  for (hal::Time now{1ms}; now < hal::Time{4ms}; now += 1ms) {
    controller.command(now);
    const auto due = controller.sync_due();
    ASSERT_EQ(due, now + canopen::sync_offset(2, 1ms, flashed.loop.network.bit_rate));
    controller.sync(*due);
    EXPECT_FALSE(controller.sync_due()) << "it left";
  }
}

constexpr hal::Time start{};
constexpr hal::Duration timeout = 500ms;

TEST(RemoteControl, ActsOnChangesAndStopsWheneverToldSo) {
  LoopProbe loop;
  RemoteAxis axis;
  axis.apply(loop, 0, {.target_counts = 5}, start);
  EXPECT_EQ(loop.stops, 1);
  axis.apply(loop, 0, {.enable = true, .reset_fault = true, .target_counts = 5}, start);
  axis.apply(loop, 0, {.enable = true, .reset_fault = true, .target_counts = 5}, start);
  EXPECT_EQ(loop.targets, std::vector<std::int32_t>{5});
  EXPECT_EQ(loop.enables, 1);
  EXPECT_EQ(loop.resets, 1);
  EXPECT_EQ(loop.stops, 1);
  axis.apply(loop, 0, {}, start);
  axis.apply(loop, 0, {}, start);
  EXPECT_EQ(loop.stops, 3);
  EXPECT_EQ(loop.targets, (std::vector<std::int32_t>{5, 0}));
}

TEST(RemoteControl, AStopAndAnEnableInOnePeriodStopTheAxisAndAreAnEdge) {
  LoopProbe loop;
  RemoteAxis axis;
  axis.apply(loop, 0, {.enable = true, .stopped = true}, start);
  EXPECT_EQ(loop.stops, 1);
  EXPECT_EQ(loop.enables, 1) << "an edge though nothing was said before";
  axis.apply(loop, 0, {.enable = true}, start);
  EXPECT_EQ(loop.stops, 1);
  axis.apply(loop, 0, {.enable = true, .stopped = true}, start);
  EXPECT_EQ(loop.stops, 2);
  EXPECT_EQ(loop.enables, 2);
  EXPECT_TRUE(loop.wanted);
}

// A controller that was restarted must not energise because somebody still says so.
TEST(RemoteControl, AnEnableOrResetThatWasSaidBeforeTheFirstCommandIsNoEdge) {
  LoopProbe loop;
  RemoteAxis axis;
  for (int i = 0; i < 100; ++i) axis.apply(loop, 0, {.enable = true, .reset_fault = true, .target_counts = 7}, start);
  EXPECT_EQ(loop.enables + loop.resets, 0);
  EXPECT_EQ(loop.targets, std::vector<std::int32_t>{7});
  axis.apply(loop, 0, {.target_counts = 7}, start);
  axis.apply(loop, 0, {.enable = true, .reset_fault = true, .target_counts = 7}, start);
  EXPECT_EQ(loop.enables, 1);
  EXPECT_EQ(loop.resets, 1);
}

TEST(RemoteControl, AResetThatIsRefusedIsTriedAgainWhileItIsSaid) {
  LoopProbe loop;
  RemoteAxis axis;
  loop.takes_resets = false;
  axis.apply(loop, 0, {}, start);
  for (int i = 0; i < 3; ++i) axis.apply(loop, 0, {.reset_fault = true}, start);
  EXPECT_EQ(loop.resets, 3);
  loop.takes_resets = true;
  for (int i = 0; i < 3; ++i) axis.apply(loop, 0, {.reset_fault = true}, start);
  EXPECT_EQ(loop.resets, 4);
}

TEST(RemoteControl, StopsAnAxisWhoseCommanderFallsSilentAndWaitsForANewEdge) {
  LoopProbe loop;
  RemoteAxis axis;
  axis.watch(loop, 0, start + 10s, timeout);
  EXPECT_TRUE(loop.stopped_with.empty()) << "nobody commanded it yet";
  axis.apply(loop, 0, {}, start);
  axis.apply(loop, 0, {.enable = true}, start);
  hal::Time now = start;
  for (; now <= start + 3s; now += 1ms) {
    if (now.time_since_epoch() % 400ms == 0ms) axis.apply(loop, 0, {.enable = true}, now);
    axis.watch(loop, 0, now, timeout);
  }
  EXPECT_TRUE(loop.stopped_with.empty());
  axis.apply(loop, 0, {.enable = true}, now);
  axis.watch(loop, 0, now + timeout, timeout);
  EXPECT_TRUE(loop.stopped_with.empty());
  axis.watch(loop, 0, now + timeout + 1ms, timeout);
  axis.watch(loop, 0, now + timeout + 2ms, timeout);
  EXPECT_EQ(loop.stopped_with, std::vector{AxisFault::commander_lost}) << "once";
  axis.apply(loop, 0, {.enable = true}, now + 2s);
  axis.apply(loop, 0, {.enable = true}, now + 2s);
  EXPECT_EQ(loop.enables, 1) << "what came late is no edge";
  axis.apply(loop, 0, {.enable = false}, now + 2s);
  axis.apply(loop, 0, {.enable = true}, now + 2s);
  EXPECT_EQ(loop.enables, 2);
}

TEST(RemoteControl, TakesAReferenceOnItsEdgeAndAgainUntilItIsTaken) {
  LoopProbe loop;
  RemoteAxis axis;
  axis.apply(loop, 0, {.reference = true, .target_counts = 1}, start);
  EXPECT_TRUE(loop.references.empty()) << "no edge";
  axis.apply(loop, 0, {.target_counts = 2}, start);
  loop.takes_resets = false;
  axis.apply(loop, 0, {.reference = true, .target_counts = 2}, start);
  loop.takes_resets = true;
  for (int i = 0; i < 3; ++i) axis.apply(loop, 0, {.reference = true, .target_counts = 2}, start);
  EXPECT_EQ(loop.references, (std::vector<std::int32_t>{2, 2}));
}

class ControlNodeTest : public ::testing::Test {
 protected:
  using Node = ControlNode<ListedPort, FlashedNode<float, 2>>;

  // The bytes of what the node told of an axis, newest last.
  std::vector<hal::CanFrame> told(std::uint8_t axis) const {
    std::vector<hal::CanFrame> frames;
    for (const auto& frame : port.sent)
      if (frame.id == canopen::tpdo_cob_id(1, node) && frame.size == 8 && frame.data[0] == axis)
        frames.push_back(frame);
    return frames;
  }
  void run(Node& controller, int periods) {
    for (int i = 0; i < periods; ++i) controller.step(now += 1ms);
  }
  // What a drive says by itself when it is switched on.
  void boot_up(std::uint8_t drive) { port.inbox.push_back({{.id = canopen::heartbeat_cob_id(drive), .size = 1}, now}); }

  ListedPort port;
  FlashedNode<float, 2> flashed = testing::certified_node();
  hal::Time now{};
};

TEST_F(ControlNodeTest, RunsANodeThatIsIntactAndCertified) {
  Node running{port, flashed};
  EXPECT_EQ(running.verdict().error, NodeError::none);
  run(running, 1);
  EXPECT_FALSE(port.sent.empty());
}

TEST_F(ControlNodeTest, IsSilentWhenRefusedAndNamesTheAxis) {
  flashed.axes[1].certified = false;
  flashed.checksum = checksum_of(flashed);
  Node refused{port, flashed};
  EXPECT_EQ(refused.verdict().error, NodeError::not_certified);
  EXPECT_EQ(refused.verdict().axis, 1);
  port.inbox.push_back({encode_command({.enable = true}, node)});
  run(refused, 100);
  EXPECT_TRUE(port.sent.empty());
}

TEST_F(ControlNodeTest, RefusesANodeThatWasEditedByHand) {
  flashed.axes[0].law.max_force_N = 51;
  EXPECT_EQ((Node{port, flashed}.verdict().error), NodeError::checksum_differs);
}

TEST_F(ControlNodeTest, TellsTheStatusOfEveryAxisEveryFiftyPeriods) {
  Node running{port, flashed};
  run(running, 100);
  EXPECT_EQ(told(0).size(), 2U);
  EXPECT_EQ(told(1).size(), 2U);
}

TEST_F(ControlNodeTest, WhateverItSendsIsStaleWhenTheNextPeriodBegins) {
  Node running{port, flashed};
  for (int i = 0; i < 100; ++i) {
    port.deadlines.clear();
    run(running, 1);
    for (const hal::Time deadline : port.deadlines) EXPECT_EQ(deadline, now + 1ms);
  }
}

TEST_F(ControlNodeTest, StopsAnAxisWhoseCommanderFallsSilent) {
  Node running{port, flashed};
  test::ScriptedDrive drive{flashed.axes[0].drive.node_id};
  drive.boot();
  const auto run_with_drive = [&](hal::Duration duration, std::optional<bool> enable) {
    for (const hal::Time end = now + duration; now < end;) {
      if (enable && now.time_since_epoch() % 100ms == 0ms)
        port.inbox.push_back({encode_command({.enable = *enable}, node), now});
      for (const hal::CanFrame& frame : std::exchange(drive.out, {})) port.inbox.push_back({frame, now});
      port.sent.clear();
      run(running, 1);
      drive.advance_to(now);
      for (const hal::CanFrame& frame : port.sent) drive.on_frame(frame);
    }
  };
  run_with_drive(1s, false);
  EXPECT_EQ(drive.state, cia402::State::switch_on_disabled);
  run_with_drive(2s, true);
  EXPECT_EQ(drive.state, cia402::State::operation_enabled) << "as long as it is said";
  run_with_drive(flashed.loop.command_timeout - 100ms, {});
  EXPECT_EQ(drive.state, cia402::State::operation_enabled);
  run_with_drive(105ms, {});
  EXPECT_NE(drive.state, cia402::State::operation_enabled);
  run_with_drive(2s, true);
  EXPECT_NE(drive.state, cia402::State::operation_enabled) << "what comes late is no edge";
}

// A command that came in the very step before it stood still is as old as that step.
TEST_F(ControlNodeTest, ObeysNoCommandFromBeforeItsLoopStoodStill) {
  Node running{port, flashed};
  test::ScriptedDrive drive{flashed.axes[0].drive.node_id};
  drive.boot();
  const auto step = [&](std::optional<bool> enable) {
    if (enable) port.inbox.push_back({encode_command({.enable = *enable}, node), now});
    for (const hal::CanFrame& frame : std::exchange(drive.out, {})) port.inbox.push_back({frame, now});
    port.sent.clear();
    run(running, 1);
    drive.advance_to(now);
    for (const hal::CanFrame& frame : port.sent) drive.on_frame(frame);
  };
  const auto repeat = [&](int periods, std::optional<bool> enable) {
    for (int i = 0; i < periods; ++i) step(i % 100 == 0 ? enable : std::nullopt);
  };
  const auto stand_still = [&] {
    for (const hal::Time end = now + 600ms; now < end; drive.advance_to(now += 1ms))
      for (const hal::CanFrame& frame : std::exchange(drive.out, {})) port.inbox.push_back({frame, now});
  };
  repeat(1000, false);
  step(true);
  stand_still();
  for (int i = 0; i < 1000; ++i) {
    step({});
    ASSERT_NE(drive.state, cia402::State::operation_enabled) << i;
  }
  repeat(200, false);
  repeat(1000, true);
  ASSERT_EQ(drive.state, cia402::State::operation_enabled);
  step(true);
  stand_still();
  repeat(20, {});
  const auto axis = *running.loop().axis(0);
  EXPECT_EQ(running.loop().status(axis).fault, AxisFault::commander_lost);
  EXPECT_NE(drive.state, cia402::State::operation_enabled);
}

TEST_F(ControlNodeTest, NamesAResetByTheWatchdogAndEnablesNothingBeforeItWasAcknowledged) {
  Node restarted{port, flashed};
  restarted.note_watchdog_reset();
  test::ScriptedDrive drive{flashed.axes[0].drive.node_id};
  drive.boot();
  const auto run_with_drive = [&](hal::Duration duration, const MotionCommand& command) {
    for (const hal::Time end = now + duration; now < end;) {
      if (now.time_since_epoch() % 100ms == 0ms) port.inbox.push_back({encode_command(command, node), now});
      for (const hal::CanFrame& frame : std::exchange(drive.out, {})) port.inbox.push_back({frame, now});
      port.sent.clear();
      run(restarted, 1);
      drive.advance_to(now);
      for (const hal::CanFrame& frame : port.sent) drive.on_frame(frame);
    }
  };
  run(restarted, 50);
  for (std::uint8_t axis = 0; axis < 2; ++axis) {
    ASSERT_FALSE(told(axis).empty());
    EXPECT_EQ(told(axis).back().data[1], static_cast<std::uint8_t>(AxisFault::watchdog_reset));
  }
  run_with_drive(1s, {});
  run_with_drive(2s, {.enable = true});
  EXPECT_NE(drive.state, cia402::State::operation_enabled);
  run_with_drive(500ms, {.reset_fault = true});
  run_with_drive(2s, {.enable = true});
  EXPECT_EQ(drive.state, cia402::State::operation_enabled);
}

TEST_F(ControlNodeTest, SetsUpTheDriveOfEveryAxis) {
  Node running{port, flashed};
  boot_up(flashed.axes[0].drive.node_id);
  boot_up(flashed.axes[1].drive.node_id);
  run(running, 20);
  for (const auto& axis : flashed.axes) {
    int asked = 0;
    for (const auto& frame : port.sent) asked += frame.id == canopen::sdo_request_cob_id(axis.drive.node_id);
    EXPECT_GT(asked, 0) << axis.name.view();
  }
}

}  // namespace
}  // namespace breakaway::firmware
