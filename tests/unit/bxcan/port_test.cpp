#include <gtest/gtest.h>

#include "port_fixture.hpp"

namespace breakaway::bxcan_test {
namespace {

static_assert(breakaway::hal::CanPort<Port>);

TEST_F(BxcanPortTest, StartsWithItsBitTimingAndInterruptsOn) {
  EXPECT_FALSE(controller.initialising());
  EXPECT_EQ(controller.read(0x1C), 0x001A0002U);
  EXPECT_EQ(controller.read(0x14), 3U);
}

TEST(BxcanRegisters, HoldBitTimingAsTheManualLaysItOut) {
  EXPECT_EQ(breakaway::bxcan::btr_value({3, 11, 2}), 0x001A0002U);
}

TEST(BxcanPort, SaysWhenTheControllerDoesNotAnswer) {
  ControllerModel controller;
  controller.stuck = true;
  Port port{controller};
  EXPECT_FALSE(port.start(timing, 1000));
}

TEST_F(BxcanPortTest, SendsFramesAsTheyAre) {
  const CanFrame frame{.id = 0x67F, .size = 8, .data = {1, 2, 3, 4, 5, 6, 7, 0xF8}};
  ASSERT_EQ(port.send(frame, now + 1ms), SendResult::queued);
  EXPECT_EQ(controller.send_one(), (RawFrame{0x67F, false, false, 8, frame.data}));
  ASSERT_EQ(port.send({.id = 0x701, .size = 1, .remote = true}, now + 1ms), SendResult::queued);
  EXPECT_EQ(controller.send_one(), (RawFrame{0x701, false, true, 1, {}}));
}

TEST_F(BxcanPortTest, SendsInOrderOfRequestThroughThreeMailboxes) {
  for (const int id : {0x201, 0x202, 0x203, 0x204, 0x205, 0x080}) ASSERT_TRUE(send(id));
  EXPECT_EQ(controller.requests(), 3U);
  EXPECT_EQ(all_sent(), (std::vector<std::uint32_t>{0x201, 0x202, 0x203, 0x204, 0x205, 0x080}));
}

TEST_F(BxcanPortTest, SaysThatTheQueueIsFull) {
  int accepted = 0;
  while (send(0x100)) ++accepted;
  EXPECT_EQ(accepted, 3 + 16);
  EXPECT_EQ(port.send(frame_of(1), now), SendResult::queue_full);
}

TEST_F(BxcanPortTest, RefusesWhatIsNoClassicFrame) {
  EXPECT_EQ(port.send({.id = 0x800}, Time{1s}), SendResult::not_sendable);
  EXPECT_EQ(port.send({.id = 1, .size = 9}, Time{1s}), SendResult::not_sendable);
}

TEST_F(BxcanPortTest, AbortsMailboxesAndDropsFramesAtTheirDeadline) {
  for (int id = 1; id <= 5; ++id) ASSERT_TRUE(send(id));
  now += 1ms;
  port.poll(now);
  EXPECT_EQ(controller.requests(), 0U);
  EXPECT_EQ(port.counters().stale, 5U);
  ASSERT_TRUE(send(6));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{6});
}

TEST_F(BxcanPortTest, KeepsFramesUntilTheirDeadline) {
  ASSERT_TRUE(send(1));
  port.poll(now + 998us);
  EXPECT_EQ(controller.requests(), 1U) << "time counts in units of 1.024 us";
  ASSERT_EQ(port.send(frame_of(2), Time::max()), SendResult::queued);
  port.poll(now + 600s);
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{2});
}

TEST_F(BxcanPortTest, ForgetsPurgedFramesInMailboxesAndQueue) {
  for (int id = 1; id <= 7; ++id) ASSERT_TRUE(send(id));
  port.purge_transmit_queue();
  EXPECT_EQ(controller.requests(), 0U);
  ASSERT_TRUE(send(8));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{8});
}

TEST_F(BxcanPortTest, ReceivesEveryBaseFrameAndNoExtendedOne) {
  EXPECT_TRUE(controller.receive({0x181, false, false, 3, {7, 8, 9}}));
  EXPECT_FALSE(controller.receive({0x181, true, false, 3, {7, 8, 9}}));
  EXPECT_TRUE(controller.receive({0x7FF, false, true, 5, {}}));
  EXPECT_TRUE(controller.receive_interrupt_pending());
  EXPECT_EQ(received(), (std::vector<CanFrame>{{.id = 0x181, .size = 3, .data = {7, 8, 9}},
                                               {.id = 0x7FF, .size = 5, .remote = true}}));
  EXPECT_FALSE(controller.receive_interrupt_pending());
}

TEST_F(BxcanPortTest, AnExtendedFrameThatPassesTheFiltersIsTakenForNoOther) {
  controller.filters_fail = true;
  EXPECT_TRUE(controller.receive({0x181U << 18, true, false, 3, {7, 8, 9}}));
  EXPECT_TRUE(controller.receive({0x182, false, false, 0, {}}));
  EXPECT_EQ(received(), std::vector<CanFrame>{{.id = 0x182}});
  EXPECT_EQ(port.counters().overflows, 0U);
}

TEST_F(BxcanPortTest, TakesALengthAboveEightForEight) {
  controller.receive({0x181, false, false, 15, {1, 2, 3, 4, 5, 6, 7, 8}});
  EXPECT_EQ(received()[0].size, 8);
}

TEST_F(BxcanPortTest, StampsFramesWithTheTimeOfTheInterrupt) {
  controller.receive({0x181, false, false, 0, {}});
  port.on_receive_interrupt(Time{7s});
  ReceivedFrame frame;
  ASSERT_TRUE(port.receive(frame));
  EXPECT_EQ(frame.time, Time{7s});
}

TEST_F(BxcanPortTest, CountsAnOverrunOfTheFifoAndGoesOn) {
  for (std::uint32_t i = 0; i < 5; ++i) controller.receive({0x180 + i, false, false, 0, {}});
  EXPECT_EQ(received().size(), 3U);
  EXPECT_EQ(port.counters().overflows, 1U);
  EXPECT_EQ(controller.read(0x0C) & 0x10U, 0U) << "acknowledged";
  controller.receive({0x190, false, false, 0, {}});
  EXPECT_EQ(received().size(), 1U);
}

TEST_F(BxcanPortTest, CountsFramesThatTheRingHasNoRoomFor) {
  for (std::uint32_t i = 0; i < 40; ++i) {
    controller.receive({i, false, false, 0, {}});
    port.on_receive_interrupt(now);
  }
  const auto frames = received();
  ASSERT_EQ(frames.size(), 32U);
  EXPECT_EQ(frames.back().id, 31U);
  EXPECT_EQ(port.counters().overflows, 8U);
}

TEST_F(BxcanPortTest, ReadsTheBusStateFromTheErrorRegister) {
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  controller.set_errors(ewgf);
  EXPECT_EQ(port.bus_state(), BusState::error_warning);
  controller.set_errors(ewgf | epvf);
  EXPECT_EQ(port.bus_state(), BusState::error_passive);
  controller.set_errors(ewgf | epvf | boff);
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
}

TEST_F(BxcanPortTest, ComesBackFromBusOffWithoutAStaleFrame) {
  for (int id = 1; id <= 5; ++id) ASSERT_EQ(port.send(frame_of(id), now + 10s), SendResult::queued);
  controller.set_errors(boff);
  EXPECT_EQ(port.send(frame_of(6), now + 10s), SendResult::bus_off);
  port.poll(now += 1ms);
  EXPECT_EQ(controller.requests(), 0U) << "purged before the controller may join again";
  EXPECT_TRUE(controller.initialising());
  port.poll(now += 1ms);
  EXPECT_FALSE(controller.initialising());
  EXPECT_EQ(port.bus_state(), BusState::bus_off) << "until the bus was idle for long enough";
  controller.recover();
  port.poll(now += 1ms);
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  ASSERT_TRUE(send(7));
  EXPECT_EQ(all_sent(), std::vector<std::uint32_t>{7});
  EXPECT_EQ(port.counters().bus_offs, 1U);
}

TEST_F(BxcanPortTest, FillsNoMailboxWhileOffTheBus) {
  controller.transmit_interrupt = nullptr;
  ASSERT_TRUE(send(1));
  controller.set_errors(boff);
  port.on_transmit_interrupt();
  EXPECT_EQ(controller.requests(), 0U);
}

TEST_F(BxcanPortTest, AcknowledgesEveryCompletion) {
  for (int id = 1; id <= 3; ++id) ASSERT_TRUE(send(id));
  while (controller.requests() > 0) {
    controller.send_one();
    EXPECT_FALSE(controller.completion_pending());
  }
}

TEST_F(BxcanPortTest, MayBeStartedAgain) {
  ASSERT_TRUE(port.start({6, 11, 2}, 10));
  EXPECT_EQ(controller.read(0x1C), 0x001A0005U);
  EXPECT_TRUE(controller.receive({0x181, false, false, 0, {}}));
}

}  // namespace
}  // namespace breakaway::bxcan_test
