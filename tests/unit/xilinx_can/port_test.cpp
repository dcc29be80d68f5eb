#include <gtest/gtest.h>

#include "port_fixture.hpp"

namespace breakaway::xilinx_can_test {
namespace {

static_assert(breakaway::hal::CanPort<Port>);

TEST(XilinxCanRegisters, HoldBitTimingAsTheManualLaysItOut) {
  EXPECT_EQ(breakaway::xilinx_can::brpr_value({5, 16, 3}), 4U);
  EXPECT_EQ(breakaway::xilinx_can::btr_value({5, 16, 3}), 0x2FU);
}

TEST_F(XilinxCanPortTest, StartsWithItsBitTimingOnTheBus) {
  EXPECT_FALSE(controller.configuring());
  EXPECT_EQ(controller.read(0x08), 9U);
  EXPECT_EQ(controller.read(0x0C), 0x16U);
  EXPECT_EQ(port.bus_state(), BusState::error_active);
}

TEST(XilinxCanPort, SaysWhenTheControllerHasNoClock) {
  ControllerModel controller;
  controller.no_clock = true;
  EXPECT_FALSE(Port{controller}.start(settings, 1000));
}

TEST(XilinxCanPort, SaysWhenTheBusIsNeverIdle) {
  ControllerModel controller;
  controller.no_idle_bus = true;
  EXPECT_FALSE(Port{controller}.start(settings, 1000));
}

TEST_F(XilinxCanPortTest, SendsFramesAsTheyAre) {
  const CanFrame frame{.id = 0x67F, .size = 8, .data = {1, 2, 3, 4, 5, 6, 7, 0xF8}};
  ASSERT_EQ(port.send(frame, now + 1ms), SendResult::queued);
  EXPECT_EQ(controller.send_one(), (RawFrame{0x67F, false, false, 8, frame.data}));
  ASSERT_EQ(port.send({.id = 0x701, .size = 1, .remote = true}, now + 1ms), SendResult::queued);
  EXPECT_EQ(controller.send_one(), (RawFrame{0x701, false, true, 1, {}}));
}

TEST_F(XilinxCanPortTest, SendsInOrderOfRequest) {
  for (const int id : {0x201, 0x202, 0x080, 0x67F}) ASSERT_TRUE(send(id));
  EXPECT_EQ(all_sent(), (std::vector<std::uint32_t>{0x201, 0x202, 0x080, 0x67F}));
}

TEST_F(XilinxCanPortTest, RefusesWhatIsNoClassicFrame) {
  EXPECT_EQ(port.send({.id = 0x800}, now + 1ms), SendResult::not_sendable);
  EXPECT_EQ(port.send({.id = 1, .size = 9}, now + 1ms), SendResult::not_sendable);
}

// By SR alone, by ISR alone as where SR never tells, or by both: the model fails the test when a full FIFO is written
// to.
TEST_F(XilinxCanPortTest, SaysThatTheFifoIsFullAndTakesFramesAgainOnceItWasEmpty) {
  for (const int told_by : {1, 2, 3}) {
    controller.shows_fullness = (told_by & 1) != 0;
    controller.latches_fullness = (told_by & 2) != 0;
    int accepted = 0;
    while (accepted < 100 && send(0x100)) ++accepted;
    EXPECT_EQ(accepted, 64);
    EXPECT_EQ(port.send(frame_of(1), now + 1ms), SendResult::queue_full);
    all_sent();
    EXPECT_TRUE(send(0x101));
    EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{0x101});
  }
  port.poll(now += 1ms);
  EXPECT_EQ(port.counters().stale, 0U);
}

TEST_F(XilinxCanPortTest, DropsFramesAtTheirDeadline) {
  for (int id = 1; id <= 5; ++id) ASSERT_TRUE(send(id));
  controller.send_one();
  port.poll(now + 999us);
  EXPECT_EQ(controller.waiting(), 4U);
  port.poll(now += 1ms);
  EXPECT_EQ(controller.waiting(), 0U);
  EXPECT_GE(port.counters().stale, 4U);
  ASSERT_TRUE(send(6));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{6});
  EXPECT_EQ(controller.read(0x08), 9U) << "set up again after the reset";
}

TEST_F(XilinxCanPortTest, KeepsFramesThatAreLateForNothing) {
  ASSERT_EQ(port.send(frame_of(1), Time::max()), SendResult::queued);
  port.poll(now + 600s);
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{1});
}

TEST_F(XilinxCanPortTest, HoldsTheEarliestDeadlineOfThoseThatWait) {
  ASSERT_TRUE(send(1));
  ASSERT_EQ(port.send(frame_of(2), now + 10s), SendResult::queued);
  port.poll(now + 1ms);
  EXPECT_EQ(controller.waiting(), 0U);
}

TEST_F(XilinxCanPortTest, NeverResetsAControllerThatSendsInTime) {
  const int resets = controller.resets;
  for (int period = 0; period < 100; ++period) {
    ASSERT_TRUE(send(0x201));
    controller.send_one();
    ASSERT_TRUE(send(0x080));  // the FIFO ran empty between the two
    controller.send_one();
    port.poll(now += 1ms);
  }
  EXPECT_EQ(controller.resets, resets);
  EXPECT_EQ(port.counters().stale, 0U);
}

TEST_F(XilinxCanPortTest, BearsABusWithoutWireTime) {
  controller.instant = true;
  const int resets = controller.resets;
  for (int period = 0; period < 100; ++period) {
    for (const int id : {0x201, 0x080, 0x67F}) ASSERT_TRUE(send(id));
    port.poll(now += 1ms);
  }
  EXPECT_EQ(controller.resets, resets);
}

TEST_F(XilinxCanPortTest, ForgetsPurgedFrames) {
  for (int id = 1; id <= 7; ++id) ASSERT_TRUE(send(id));
  port.purge_transmit_queue();
  EXPECT_EQ(controller.waiting(), 0U);
  ASSERT_TRUE(send(8));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{8});
}

TEST_F(XilinxCanPortTest, PurgesNothingWithoutAReset) {
  ASSERT_TRUE(send(1));
  controller.send_one();
  const int resets = controller.resets;
  port.purge_transmit_queue();
  EXPECT_EQ(controller.resets, resets) << "a reset would take the node off the bus for a while";
}

TEST_F(XilinxCanPortTest, LosesNoReceivedFrameToAPurge) {
  ASSERT_TRUE(send(1));
  ASSERT_TRUE(controller.receive({0x181, false, false, 1, {7}}));
  port.purge_transmit_queue();
  EXPECT_EQ(received().size(), 1U);
}

TEST_F(XilinxCanPortTest, ReceivesEveryBaseFrameAndNoExtendedOne) {
  EXPECT_TRUE(controller.receive({0x181, false, false, 3, {7, 8, 9}}));
  EXPECT_FALSE(controller.receive({0x0604'0000, true, false, 3, {7, 8, 9}}));
  EXPECT_TRUE(controller.receive({0x7FF, false, true, 5, {}}));
  EXPECT_EQ(received(), (std::vector<CanFrame>{{.id = 0x181, .size = 3, .data = {7, 8, 9}},
                                               {.id = 0x7FF, .size = 5, .remote = true}}));
  EXPECT_FALSE(controller.underflowed());
}

TEST_F(XilinxCanPortTest, AnExtendedFrameThatPassesTheFiltersIsTakenForNoOther) {
  controller.filters_fail = true;
  EXPECT_TRUE(controller.receive({0x181U << 18, true, false, 3, {7, 8, 9}}));
  EXPECT_TRUE(controller.receive({0x182, false, false, 0, {}}));
  EXPECT_EQ(received(), std::vector<CanFrame>{{.id = 0x182}});
  EXPECT_EQ(port.counters().overflows, 0U);
}

TEST_F(XilinxCanPortTest, ReceivesWhatPassesAFilter) {
  BusSettings filtered = settings;
  filtered.accepted = {Filter{0x07F, 1}, {}, {}, Filter{0x7FF, 0x27F}};
  ASSERT_TRUE(port.start(filtered, 10));
  for (const std::uint32_t id : {0x181U, 0x182U, 0x581U, 0x27FU, 0x17FU, 0x080U, 0x701U})
    controller.receive({id, false, false, 0, {}});
  std::vector<int> ids;
  for (const CanFrame& frame : received()) ids.push_back(frame.id);
  EXPECT_EQ(ids, (std::vector<int>{0x181, 0x581, 0x27F, 0x701}));
}

TEST_F(XilinxCanPortTest, TakesALengthAboveEightForEight) {
  controller.receive({0x181, false, false, 15, {1, 2, 3, 4, 5, 6, 7, 8}});
  const auto frames = received();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].size, 8);
  EXPECT_EQ(frames[0].data[7], 8);
}

TEST_F(XilinxCanPortTest, StampsFramesWithTheTimeOfThePoll) {
  controller.receive({0x181, false, false, 0, {}});
  port.poll(Time{7s});
  port.poll(Time{8s});
  ReceivedFrame frame;
  ASSERT_TRUE(port.receive(frame));
  EXPECT_EQ(frame.time, Time{7s});
}

TEST_F(XilinxCanPortTest, CountsAnOverflowOfTheFifoAndGoesOn) {
  for (std::uint32_t i = 0; i < 70; ++i) controller.receive({i, false, false, 0, {}});
  EXPECT_EQ(received().size(), 64U);
  EXPECT_EQ(port.counters().overflows, 1U);
  controller.receive({0x190, false, false, 0, {}});
  EXPECT_EQ(received().size(), 1U);
  EXPECT_EQ(port.counters().overflows, 1U) << "counted once";
}

TEST_F(XilinxCanPortTest, CountsFramesThatNobodyTook) {
  for (std::uint32_t i = 0; i < 70; ++i) {
    controller.receive({i, false, false, 0, {}});
    port.poll(now);
  }
  const auto frames = received();
  ASSERT_EQ(frames.size(), 64U);
  EXPECT_EQ(frames.back().id, 63U);
  EXPECT_EQ(port.counters().overflows, 6U);
}

// Without another node on the bus, a frame is tried for ever and the node goes error passive, not off the bus.
TEST_F(XilinxCanPortTest, SendsNoStaleFrameOnceSomebodyAcknowledges) {
  ASSERT_TRUE(send(0x201));
  while (port.bus_state() == BusState::error_active) controller.fail_to_send();
  EXPECT_EQ(port.bus_state(), BusState::error_warning);
  for (int i = 0; i < 100; ++i) controller.fail_to_send();
  EXPECT_EQ(port.bus_state(), BusState::error_passive);
  port.poll(now += 1ms);
  ASSERT_TRUE(send(0x202));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{0x202});
}

TEST_F(XilinxCanPortTest, ComesBackFromBusOffWithoutAStaleFrame) {
  for (int id = 1; id <= 5; ++id) ASSERT_EQ(port.send(frame_of(id), now + 10s), SendResult::queued);
  pass_until_bus_off();
  EXPECT_EQ(port.send(frame_of(6), now + 10s), SendResult::bus_off);
  port.poll(now);
  EXPECT_EQ(controller.waiting(), 0U) << "purged before the controller may join again";
  EXPECT_TRUE(controller.configuring());
  port.poll(now + 1407us);
  EXPECT_EQ(port.bus_state(), BusState::bus_off) << "128 x 11 bits at 1 Mbit/s are 1408 us";
  EXPECT_EQ(port.send(frame_of(6), now + 10s), SendResult::bus_off);
  port.poll(now += 1408us);
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  ASSERT_TRUE(send(7));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{7});
  EXPECT_EQ(port.counters().bus_offs, 1U);
}

// The controller may come back between two polls, and would send what it still has.
TEST_F(XilinxCanPortTest, NoticesABusOffThatIsOverAlready) {
  ASSERT_EQ(port.send(frame_of(1), now + 10s), SendResult::queued);
  pass_until_bus_off();
  controller.recover_by_itself();
  port.poll(now);
  EXPECT_EQ(controller.waiting(), 0U);
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
}

TEST_F(XilinxCanPortTest, StaysOffTheBusWhileTheControllerDoesNotReset) {
  ASSERT_TRUE(send(1));
  pass_until_bus_off();
  port.poll(now);
  controller.no_clock = true;
  port.poll(now += 10ms);
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
  controller.no_clock = false;
  port.poll(now += 1ms);
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  EXPECT_EQ(controller.read(0x08), 9U);
}

TEST_F(XilinxCanPortTest, MayBeStartedAgain) {
  BusSettings slower = settings;
  slower.timing.prescaler = 20;
  ASSERT_TRUE(port.start(slower, 10));
  EXPECT_EQ(controller.read(0x08), 19U);
  EXPECT_TRUE(controller.receive({0x181, false, false, 0, {}}));
}

}  // namespace
}  // namespace breakaway::xilinx_can_test
