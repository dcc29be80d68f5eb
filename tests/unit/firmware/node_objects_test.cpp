// What another node reads and writes of a controller node by SDO.
#include "breakaway/firmware/node_objects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../cia402/scripted_drive.hpp"
#include "breakaway/canopen/sdo_client.hpp"
#include "breakaway/firmware/control_node.hpp"
#include "certified_node.hpp"
#include "listed_port.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using canopen::SdoAbort;
using canopen::SdoResult;
using canopen::SdoStart;

constexpr std::uint8_t own_id = 0x7F;

// A controller node of two axes, the drive of the first, and a tool on the bus.
struct World {
  using Node = ControlNode<ListedPort, FlashedNode<float, 2>>;

  World() = default;
  template <class Change>
  explicit World(Change change) : flashed{changed(change)} {}
  template <class Change>
  static FlashedNode<float, 2> changed(Change change) {
    FlashedNode<float, 2> node = testing::certified_node();
    change(node);
    node.checksum = checksum_of(node);
    return node;
  }

  void step() {
    now += 1ms;
    for (const hal::CanFrame& frame : std::exchange(drive.out, {})) port.inbox.push_back({frame, now});
    hal::CanFrame asked;
    if (tool.next_frame(asked, now)) port.inbox.push_back({asked, now});
    if (said) port.inbox.push_back({encode_command(*said, own_id), now});
    port.sent.clear();
    controller.step(now);
    drive.advance_to(now);
    answers = 0;
    for (const hal::CanFrame& frame : port.sent) {
      drive.on_frame(frame);
      tool.on_frame(frame);
      answers += frame.id == canopen::sdo_response_cob_id(own_id) ? 1 : 0;
      if (frame.id != canopen::sdo_response_cob_id(own_id)) others.push_back(frame);
    }
    EXPECT_LE(answers, 1);
  }
  SdoResult finish() {
    for (int period = 0; tool.busy() && period < 200; ++period) step();
    return tool.poll(now);
  }
  std::string text(std::uint16_t index, std::uint8_t subindex) {
    EXPECT_EQ(tool.start_read(index, subindex), SdoStart::started);
    EXPECT_EQ(finish(), SdoResult::done);
    return {tool.data().begin(), tool.data().end()};
  }
  template <class T>
  T number(std::uint16_t index, std::uint8_t subindex) {
    EXPECT_EQ(tool.start_read(index, subindex), SdoStart::started);
    EXPECT_EQ(finish(), SdoResult::done) << index << ':' << int{subindex};
    EXPECT_EQ(tool.data().size(), sizeof(T)) << index << ':' << int{subindex};
    return canopen::load_little_endian<T>(tool.data());
  }
  float real(std::uint16_t index, std::uint8_t subindex) {
    return std::bit_cast<float>(number<std::uint32_t>(index, subindex));
  }
  SdoAbort why_not_read(std::uint16_t index, std::uint8_t subindex) {
    EXPECT_EQ(tool.start_read(index, subindex), SdoStart::started);
    EXPECT_EQ(finish(), SdoResult::aborted);
    return tool.abort_code();
  }
  SdoResult write(std::uint16_t index, std::uint8_t subindex, const std::vector<std::uint8_t>& bytes) {
    EXPECT_EQ(tool.start_write(index, subindex, bytes), SdoStart::started);
    return finish();
  }
  void run(hal::Duration duration) {
    for (const hal::Time end = now + duration; now < end;) step();
  }
  // As a commander does it that says its commands again and again.
  void enable() {
    said = MotionCommand{.target_counts = drive.counts};
    run(1s);
    said->enable = true;
    run(1s);
    ASSERT_EQ(drive.state, cia402::State::operation_enabled);
  }

  ListedPort port;
  FlashedNode<float, 2> flashed = testing::certified_node();
  Node controller{port, flashed};
  test::ScriptedDrive drive{flashed.axes[0].drive.node_id};
  canopen::SdoClient tool{own_id, 100ms};
  std::optional<MotionCommand> said;
  std::vector<hal::CanFrame> others;  // what the node sent beside its answers
  int answers = 0;
  hal::Time now{};
};

class NodeObjectsTest : public ::testing::Test, protected World {};

TEST_F(NodeObjectsTest, TellsWhoItIs) {
  EXPECT_EQ(number<std::uint32_t>(0x1000, 0), 0U);
  EXPECT_EQ(text(0x1008, 0), "breakaway");
  EXPECT_EQ(number<std::uint8_t>(0x1018, 0), 4);
  for (std::uint8_t nobody = 1; nobody <= 3; ++nobody)
    EXPECT_EQ(number<std::uint32_t>(0x1018, nobody), 0U) << "no vendor's";
  EXPECT_EQ(number<std::uint32_t>(0x1018, 4), flashed.checksum);
  EXPECT_EQ(number<std::uint16_t>(0x1017, 0), flashed.loop.network.heartbeat_period / 1ms);
  EXPECT_EQ(number<std::uint32_t>(0x1200, 1), 0x67FU);
  EXPECT_EQ(number<std::uint32_t>(0x1200, 2), 0x5FFU);
}

TEST_F(NodeObjectsTest, TellsHowTheLoopRuns) {
  EXPECT_EQ(number<std::uint8_t>(0x2000, 1), 2);
  EXPECT_EQ(number<std::uint32_t>(0x2000, 2), 1'000'000U);
  run(100ms);
  const auto ticks = number<std::uint32_t>(0x2000, 3);
  EXPECT_GE(ticks, 100U);
  EXPECT_LE(ticks, 110U);
  EXPECT_EQ(number<std::uint32_t>(0x2000, 4), 0U);
  now += 3ms;
  step();
  EXPECT_EQ(number<std::uint32_t>(0x2000, 4), 3U);
  EXPECT_EQ(number<std::uint32_t>(0x2000, 5), 1'000'000U);
  EXPECT_EQ(number<std::uint32_t>(0x2000, 6), 4'000'000U);
  EXPECT_EQ(number<std::uint32_t>(0x2000, 7), 0U);
}

TEST_F(NodeObjectsTest, TellsIntervalsBeyondItsNumbersByTheLastOfThem) {
  run(10ms);
  now -= 5ms;
  step();
  EXPECT_EQ(number<std::uint32_t>(0x2000, 5), 0U) << "of a clock that went back";
  now += 5s;
  step();
  EXPECT_EQ(number<std::uint32_t>(0x2000, 6), 0xFFFF'FFFFU) << "more than 4.29 s";
}

TEST_F(NodeObjectsTest, TellsAtWhichObjectASetUpEnded) {
  drive.objects[test::ScriptedDrive::key(0x607B, 1)] = 1;
  drive.boot();
  run(1s);
  EXPECT_EQ(number<std::uint8_t>(0x2101, 0x0E), static_cast<std::uint8_t>(cia402::SetupStatus::position_wraps));
  EXPECT_EQ(number<std::uint32_t>(0x2101, 0x0F), 0x607B01U);
}

TEST_F(NodeObjectsTest, TellsWhatEveryAxisDoes) {
  drive.counts = 4321;
  drive.boot();
  enable();
  said->target_counts = 100'000;
  float largest_N = 0;
  for (int i = 0; i < 20; ++i) largest_N = std::max(largest_N, real(0x2101, 5));
  EXPECT_GT(largest_N, 1.0F);
  EXPECT_EQ(text(0x2101, 1), flashed.axes[0].name.view());
  EXPECT_EQ(text(0x2102, 1), flashed.axes[1].name.view());
  EXPECT_EQ(number<std::int32_t>(0x2101, 2), 100'000);
  EXPECT_EQ(number<std::int32_t>(0x2101, 3), 4321);
  EXPECT_FLOAT_EQ(real(0x2101, 4), 4321 * flashed.axes[0].law.encoder_resolution_m);
  EXPECT_EQ(real(0x2101, 6), 0.0F);
  const auto& status = controller.loop().status(*controller.loop().axis(0));
  EXPECT_EQ(number<std::uint8_t>(0x2101, 7), static_cast<std::uint8_t>(status.output.mode));
  EXPECT_EQ(number<std::uint8_t>(0x2101, 8), static_cast<std::uint8_t>(hal::DriveState::enabled));
  EXPECT_EQ(number<std::uint8_t>(0x2102, 8), static_cast<std::uint8_t>(hal::DriveState::configuring));
  EXPECT_EQ(number<std::uint8_t>(0x2101, 9), 0);
  EXPECT_EQ(text(0x2101, 0x0A), "none");
  EXPECT_EQ(number<std::uint8_t>(0x1001, 0), 0);
  EXPECT_EQ(number<std::uint16_t>(0x2101, 0x0D) & 0x6FU, 0x27U);
  EXPECT_EQ(number<std::uint8_t>(0x2101, 0x0E), static_cast<std::uint8_t>(cia402::SetupStatus::ready));
}

TEST_F(NodeObjectsTest, TellsAFaultByNumberNameAndCode) {
  drive.boot();
  enable();
  drive.emergency(0x2310);
  run(5ms);
  EXPECT_EQ(number<std::uint8_t>(0x2101, 9), static_cast<std::uint8_t>(AxisFault::emergency));
  EXPECT_EQ(text(0x2101, 0x0A), "drive emergency");
  EXPECT_EQ(number<std::uint16_t>(0x2101, 0x0B), 0x2310);
  EXPECT_EQ(number<std::uint16_t>(0x2101, 0x10), 0x2310);
  EXPECT_EQ(number<std::uint8_t>(0x1001, 0), 1);
  EXPECT_EQ(number<std::uint8_t>(0x2101, 0x0C), 0);
}

TEST_F(NodeObjectsTest, ATargetMayBeWrittenAndNothingElse) {
  drive.boot();
  enable();
  EXPECT_EQ(write(0x2101, 2, {0xA0, 0x86, 1, 0}), SdoResult::done);
  EXPECT_EQ(number<std::int32_t>(0x2101, 2), 100'000);
  std::int16_t most = 0;
  for (int i = 0; i < 50; ++i) {
    step();
    most = std::max(most, drive.target);
  }
  EXPECT_GT(most, 0) << "it goes there, whatever the commander goes on saying";
  EXPECT_EQ(write(0x2101, 2, {1, 0}), SdoResult::aborted);
  EXPECT_EQ(tool.abort_code(), SdoAbort::length_mismatch);
  for (std::uint8_t subindex = 0; subindex <= 0x10; ++subindex) {
    if (subindex == 2) continue;
    EXPECT_EQ(write(0x2101, subindex, {1, 0, 0, 0}), SdoResult::aborted) << int{subindex};
    EXPECT_EQ(tool.abort_code(), SdoAbort::read_only);
  }
  EXPECT_EQ(write(0x1017, 0, {1, 0}), SdoResult::aborted);
  EXPECT_EQ(write(0x2103, 2, {1, 0, 0, 0}), SdoResult::aborted);
  EXPECT_EQ(tool.abort_code(), SdoAbort::no_such_object);
}

TEST_F(NodeObjectsTest, ATargetIsRefusedUnlessACommanderKeepsTheAxisEnabled) {
  const std::vector<std::uint8_t> far{0xA0, 0x86, 1, 0};
  drive.boot();
  run(1s);
  EXPECT_EQ(write(0x2101, 2, far), SdoResult::aborted) << "nobody commands it";
  EXPECT_EQ(tool.abort_code(), SdoAbort::device_state);
  enable();
  EXPECT_EQ(write(0x2101, 2, far), SdoResult::done);
  EXPECT_EQ(write(0x2102, 2, far), SdoResult::aborted) << "the other axis is not enabled";
  said.reset();
  run(flashed.loop.command_timeout + 2ms);
  EXPECT_EQ(number<std::uint8_t>(0x2101, 9), static_cast<std::uint8_t>(AxisFault::commander_lost));
  EXPECT_EQ(write(0x2101, 2, far), SdoResult::aborted) << "a commander that is silent keeps nothing enabled";
  EXPECT_EQ(tool.abort_code(), SdoAbort::device_state);
}

TEST_F(NodeObjectsTest, ATargetThatIsWrittenDoesNotOutlastTheEnabling) {
  drive.boot();
  enable();
  EXPECT_EQ(write(0x2101, 2, {0xA0, 0x86, 1, 0}), SdoResult::done);
  said->enable = false;
  run(1s);
  EXPECT_EQ(number<std::int32_t>(0x2101, 2), 100'000) << "the commander goes on saying what it said before";
  said->enable = true;
  run(2ms);
  EXPECT_EQ(number<std::int32_t>(0x2101, 2), said->target_counts);
}

TEST(NodeObjects, ATargetBeyondTheLimitsOfPositionIsRefusedByTheCodesOfTheStandard) {
  World world{[](FlashedNode<float, 2>& node) {
    node.axes[0].limits.position_min_m = -0.05F;
    node.axes[0].limits.position_max_m = 0.1F;
  }};
  world.drive.boot();
  world.enable();
  // 1 um a count: 99990, 100010 and -50010.
  EXPECT_EQ(world.write(0x2101, 2, {0x96, 0x86, 1, 0}), SdoResult::done);
  EXPECT_EQ(world.write(0x2101, 2, {0xAA, 0x86, 1, 0}), SdoResult::aborted);
  EXPECT_EQ(world.tool.abort_code(), SdoAbort::value_too_high);
  EXPECT_EQ(world.write(0x2101, 2, {0xA6, 0x3C, 0xFF, 0xFF}), SdoResult::aborted);
  EXPECT_EQ(world.tool.abort_code(), SdoAbort::value_too_low);
  EXPECT_EQ(world.number<std::int32_t>(0x2101, 2), 99'990);
}

TEST(NodeObjects, ATargetMayBeAtTheLimitsOfPosition) {
  constexpr float micrometre = 1e-6F;
  World world{[](FlashedNode<float, 2>& node) {
    node.axes[0].limits.position_min_m = -50'000 * micrometre;
    node.axes[0].limits.position_max_m = 100'000 * micrometre;
  }};
  world.drive.boot();
  world.enable();
  EXPECT_EQ(world.write(0x2101, 2, {0xA0, 0x86, 1, 0}), SdoResult::done) << "100000";
  EXPECT_EQ(world.write(0x2101, 2, {0xB0, 0x3C, 0xFF, 0xFF}), SdoResult::done) << "-50000";
}

// Whoever has no SdoServer asks them himself.
TEST(NodeObjects, SayThatAnAxisThatIsNotThereCannotBeWritten) {
  const FlashedNode<float, 2> node = testing::certified_node();
  ListedPort port;
  ControlLoop<ListedPort, cia402::Drive<float>, law::AxisController<float>, float, 2> loop{port, node.loop};
  NodeObjects objects{loop, node};
  constexpr std::array<std::uint8_t, 4> zero{};
  EXPECT_EQ(objects.write({0x2101, 2}, zero), SdoAbort::no_such_object);
  add_axes(loop, node);
  EXPECT_EQ(objects.write({0x2101, 2}, zero), SdoAbort::device_state) << "it is there, and nobody wants it";
  EXPECT_EQ(objects.write({0x2103, 2}, zero), SdoAbort::no_such_object);
  EXPECT_EQ(objects.write({0x2101, 0x11}, zero), SdoAbort::no_such_subindex);
}

TEST_F(NodeObjectsTest, RefusesWhatIsNotThere) {
  EXPECT_EQ(why_not_read(0x2103, 1), SdoAbort::no_such_object) << "there are two axes";
  EXPECT_EQ(why_not_read(0x2101, 0x11), SdoAbort::no_such_subindex);
  EXPECT_EQ(number<std::uint8_t>(0x2101, 0), 0x10);
  EXPECT_EQ(number<std::uint8_t>(0x2000, 0), 7);
  EXPECT_EQ(why_not_read(0x2000, 8), SdoAbort::no_such_subindex);
  EXPECT_EQ(why_not_read(0x1008, 1), SdoAbort::no_such_subindex);
  EXPECT_EQ(why_not_read(0x6041, 0), SdoAbort::no_such_object);
}

// Every frame to the drives is the same whether somebody looks or not.
TEST_F(NodeObjectsTest, WhoeverLooksDisturbsNothing) {
  World quiet, watched;
  for (World* const world : {&quiet, &watched}) {
    world->drive.boot();
    world->enable();
    world->said->target_counts = 20'000;
  }
  int read = 0;
  for (int period = 0; period < 1000; ++period) {
    if (!watched.tool.busy()) {
      const auto subindex = static_cast<std::uint8_t>(read++ % 18);
      ASSERT_EQ(watched.tool.start_read(0x2101, subindex), SdoStart::started);
    }
    watched.step();
    static_cast<void>(watched.tool.poll(watched.now));
    quiet.step();
  }
  EXPECT_GT(read, 300);
  EXPECT_EQ(watched.others, quiet.others);
  EXPECT_EQ(watched.controller.loop().status(*watched.controller.loop().axis(0)).fault, AxisFault::none);
}

}  // namespace
}  // namespace breakaway::firmware
