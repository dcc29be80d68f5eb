// The bounds of what the port waits for and counts, what a start begins anew, and each bus state.
#include <gtest/gtest.h>

#include <algorithm>

#include "../fixed_registers.hpp"
#include "port_fixture.hpp"

namespace breakaway::xilinx_can_test {
namespace {

using breakaway::testing::FixedRegisters;
using breakaway::xilinx_can::Counters;

class XilinxCanEdgesTest : public XilinxCanPortTest {};

TEST(XilinxCanRegisterReads, AreAsManyAtTheStartAsWereAllowed) {
  for (const std::uint32_t status : {0U, 1U}) {
    FixedRegisters controller;
    controller.values[0x18] = status;
    breakaway::xilinx_can::Port<FixedRegisters> port{controller};
    EXPECT_FALSE(port.start(settings, 10));
    EXPECT_EQ(controller.reads[0x18], status == 0 ? 10 : 1 + 10) << "to enter the configuration mode, and to leave it";
  }
}

TEST(XilinxCanRegisterReads, EndWhenTheFifoNeverEmpties) {
  FixedRegisters controller;
  controller.values[0x1C] = 1U << 7;
  breakaway::xilinx_can::Port<FixedRegisters> port{controller};
  port.poll(Time{1s});
  EXPECT_EQ(controller.reads[0x50], 64) << "as many as the FIFO holds";
}

TEST(XilinxCanBusState, IsReadFromTheStatusRegister) {
  struct Row {
    const char* label;
    std::uint32_t status;
    BusState state;
  };
  constexpr std::uint32_t others = ~(0b111U << 6);  // every bit that says something else
  for (const Row& row : {Row{"active", 0b01U << 7, BusState::error_active},
                         Row{"active, warning", 0b01U << 7 | 1U << 6, BusState::error_warning},
                         Row{"passive", 0b11U << 7 | 1U << 6, BusState::error_passive},
                         Row{"off the bus", 0b10U << 7 | 1U << 6, BusState::bus_off}}) {
    for (const std::uint32_t beside : {0U, others}) {
      FixedRegisters controller;
      controller.values[0x18] = row.status | beside;
      controller.values[0x1C] = ~(1U << 9);
      EXPECT_EQ(breakaway::xilinx_can::Port<FixedRegisters>{controller}.bus_state(), row.state) << row.label;
    }
  }
}

TEST(XilinxCanDefaults, AreAMegabitAndEveryFrame) {
  EXPECT_EQ(BusSettings{}.bit_rate, 1'000'000U);
  EXPECT_EQ(Filter{}.mask, 0U);
  EXPECT_EQ(Filter{}.id, 0U);
  const Counters none{};
  EXPECT_EQ(none.stale + none.overflows + none.bus_offs, 0U);
}

TEST_F(XilinxCanEdgesTest, RunsInNormalModeWithoutInterrupts) {
  EXPECT_EQ(controller.read(0x04), 0U);
  EXPECT_EQ(controller.read(0x20), 0U);
}

TEST_F(XilinxCanEdgesTest, AStartEndsARecovery) {
  while (port.bus_state() != BusState::bus_off) {
    if (controller.waiting() == 0) {
      ASSERT_TRUE(send(1));
    }
    controller.disturb_sending();
  }
  port.poll(now);
  ASSERT_TRUE(port.start(settings, 10));
  EXPECT_EQ(port.bus_state(), BusState::error_active);
  EXPECT_TRUE(send(2));
}

// A reset would begin the sequence of 128 times 11 recessive bits anew.
TEST_F(XilinxCanEdgesTest, APurgeLeavesARecoveryAlone) {
  while (port.bus_state() != BusState::bus_off) {
    if (controller.waiting() == 0) {
      ASSERT_TRUE(send(1));
    }
    controller.disturb_sending();
  }
  port.poll(now);
  const int resets = controller.resets;
  port.purge_transmit_queue();
  EXPECT_EQ(controller.resets, resets);
  EXPECT_EQ(port.bus_state(), BusState::bus_off);
}

TEST_F(XilinxCanEdgesTest, AStartForgetsWhatWasToBeSent) {
  ASSERT_TRUE(send(1));
  ASSERT_TRUE(port.start(settings, 10));
  const int resets = controller.resets;
  port.poll(now + 1ms);
  EXPECT_EQ(controller.resets, resets);
  EXPECT_EQ(port.counters().stale, 0U);
}

TEST_F(XilinxCanEdgesTest, ASingleFrameIsPurgedToo) {
  ASSERT_TRUE(send(1));
  port.purge_transmit_queue();
  EXPECT_EQ(controller.waiting(), 0U);
}

TEST_F(XilinxCanEdgesTest, FramesAtTheirDeadlineAreCounted) {
  for (int id = 1; id <= 5; ++id) ASSERT_TRUE(send(id));
  port.poll(now + 1ms);
  EXPECT_EQ(port.counters().stale, 5U);
}

TEST_F(XilinxCanEdgesTest, ReceivesEveryLengthAndEveryByte) {
  for (std::uint32_t length = 0; length < 16; ++length) {
    ASSERT_TRUE(controller.receive({0x7F0 | length, false, false, length, {0x81, 2, 3, 4, 0x85, 6, 7, 8}}));
    port.poll(now);
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
}  // namespace breakaway::xilinx_can_test
