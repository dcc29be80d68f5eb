// The bounds of what the port waits for and counts, and the registers that it shares with others.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "../fixed_registers.hpp"
#include "port_fixture.hpp"

namespace breakaway::bxcan_test {
namespace {

using breakaway::bxcan::Counters;
using breakaway::testing::FixedRegisters;

class BxcanEdgesTest : public BxcanPortTest {};

TEST(BxcanRegisterReads, AreAsManyAtTheStartAsWereAllowed) {
  for (const std::uint32_t msr : {0U, 1U}) {
    FixedRegisters controller;
    controller.values[0x04] = msr;
    breakaway::bxcan::Port<FixedRegisters> port{controller};
    EXPECT_FALSE(port.start(timing, 10));
    EXPECT_EQ(controller.reads[0x04], msr == 0 ? 10 : 1 + 10) << "to enter the initialisation mode, and to leave it";
  }
}

// Frames for ever, and a release that is never done.
TEST(BxcanRegisterReads, EndWhenTheFifoNeverEmpties) {
  FixedRegisters controller;
  controller.values[0x0C] = 1U | 1U << 5;
  breakaway::bxcan::Port<FixedRegisters> port{controller};
  port.on_receive_interrupt(Time{1s});
  EXPECT_EQ(controller.reads[0x1B0], 16);
  EXPECT_LE(controller.reads[0x0C], 16 * (1 + 16) + 1);
  EXPECT_EQ(port.counters().overflows, 0U);
}

TEST(BxcanFilters, TakeBankZeroAndLeaveTheOthersAsTheyAre) {
  for (const std::uint32_t found : {0U, 0xFFFF'FFFFU}) {
    ControllerModel controller;
    for (const std::uint32_t offset : {0x204U, 0x20CU, 0x214U, 0x21CU, 0x240U, 0x244U}) controller.write(offset, found);
    ASSERT_TRUE(Port{controller}.start(timing, 10));
    const std::uint32_t others = found & ~1U;
    EXPECT_EQ(controller.read(0x204), others) << "identifier and mask";
    EXPECT_EQ(controller.read(0x20C), others | 1U) << "of 32 bits";
    EXPECT_EQ(controller.read(0x214), others) << "to FIFO 0";
    EXPECT_EQ(controller.read(0x21C), others | 1U) << "active";
    EXPECT_EQ(controller.read(0x240), 0U);
    EXPECT_EQ(controller.read(0x244), 4U);
    EXPECT_EQ(controller.read(0x200), 0x2A1C0E00U)
        << "filters are in use, and the share of the second controller stays";
  }
}

TEST(BxcanCounters, BeginAtZero) {
  const Counters none{};
  EXPECT_EQ(none.stale + none.overflows + none.bus_offs, 0U);
}

TEST_F(BxcanEdgesTest, AFrameIsLateFromItsDeadlineOn) {
  for (const int units : {4'882'813, 4'882'814}) {
    const Time deadline{units * 1024ns};
    now = deadline - 10us;
    port.poll(now);
    const std::uint32_t stale = port.counters().stale;
    ASSERT_TRUE(send(1, deadline));
    port.poll(deadline - 1ns);
    EXPECT_EQ(controller.requests(), 1U);
    port.poll(deadline);
    EXPECT_EQ(controller.requests(), 0U);
    EXPECT_EQ(port.counters().stale, stale + 1);
  }
}

TEST_F(BxcanEdgesTest, AFrameWithoutADeadlineIsKeptForAThousandSeconds) {
  port.poll(now = Time{9000s});
  ASSERT_TRUE(send(1, Time::max()));
  port.poll(now + 999s);
  EXPECT_EQ(controller.requests(), 1U);
  port.poll(now + 1001s);
  EXPECT_EQ(controller.requests(), 0U);
}

TEST_F(BxcanEdgesTest, AFrameThatCannotBeAbortedAnyMoreIsCountedOnce) {
  controller.frame_on_wire = true;
  ASSERT_TRUE(send(1, now + 1ms));
  for (int i = 1; i <= 3; ++i) port.poll(now + i * 1ms);
  EXPECT_EQ(controller.requests(), 1U);
  EXPECT_EQ(port.counters().stale, 1U);
  controller.send_one();
  controller.frame_on_wire = false;
  ASSERT_TRUE(send(2, now + 10ms));
  port.poll(now + 10ms);
  EXPECT_EQ(port.counters().stale, 2U) << "the next one in that mailbox counts anew";
}

TEST_F(BxcanEdgesTest, APurgedFrameIsNotStale) {
  for (int id = 1; id <= 5; ++id) ASSERT_TRUE(send(id, now + 1ms));
  port.purge_transmit_queue();
  port.poll(now + 2ms);
  EXPECT_EQ(port.counters().stale, 0U);
}

TEST_F(BxcanEdgesTest, AWarningOfErrorsKeepsNothingFromTheBus) {
  controller.set_errors(ewgf);
  port.poll(now);
  ASSERT_TRUE(send(1, now + 1ms));
  EXPECT_EQ(controller.requests(), 1U);
  EXPECT_EQ(port.counters().bus_offs, 0U);
}

TEST_F(BxcanEdgesTest, EveryBusOffIsCountedAndLeftAnew) {
  for (std::uint32_t n = 1; n <= 3; ++n) {
    controller.set_errors(boff);
    port.poll(now += 1ms);
    EXPECT_TRUE(controller.initialising());
    port.poll(now += 1ms);
    controller.recover();
    port.poll(now += 1ms);
    EXPECT_EQ(port.bus_state(), BusState::error_active);
    EXPECT_EQ(port.counters().bus_offs, n);
  }
}

TEST(BxcanBusOff, IsNoticedInTheFirstPeriod) {
  ControllerModel controller;
  Port port{controller};
  ASSERT_TRUE(port.start(timing, 10));
  controller.set_errors(boff);
  port.poll(Time{5s});
  EXPECT_TRUE(controller.initialising());
  EXPECT_EQ(port.counters().bus_offs, 1U);
}

TEST_F(BxcanEdgesTest, WaitsForTheInitialisationModeBeforeItLeavesIt) {
  controller.set_errors(boff);
  controller.stuck = true;
  for (int i = 0; i < 3; ++i) {
    port.poll(now += 1ms);
    EXPECT_EQ(controller.read(0x00) & 1U, 1U) << "still asked for";
  }
}

TEST_F(BxcanEdgesTest, ReceivesEveryLengthAndEveryByte) {
  for (std::uint32_t length = 0; length < 16; ++length) {
    ASSERT_TRUE(controller.receive({0x7F0 | length, false, false, length, {0x81, 2, 3, 4, 0x85, 6, 7, 8}}));
    port.on_receive_interrupt(now);
    ReceivedFrame r;
    ASSERT_TRUE(port.receive(r));
    CanFrame expected{.id = static_cast<std::uint16_t>(0x7F0 | length), .data = {}};
    expected.size = static_cast<std::uint8_t>(std::min(length, 8U));
    for (std::uint8_t i = 0; i < expected.size; ++i)
      expected.data[i] = static_cast<std::uint8_t>(i + 1 + (i % 4 == 0 ? 0x80 : 0));
    EXPECT_EQ(r.frame, expected) << length;
    EXPECT_FALSE(port.receive(r)) << "one frame came";
  }
}

}  // namespace
}  // namespace breakaway::bxcan_test
