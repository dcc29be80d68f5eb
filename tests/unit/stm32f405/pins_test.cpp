#include "pins.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "can_controller.hpp"

namespace {

using namespace breakaway::stm32f405;
using breakaway::firmware::pin;
using breakaway::firmware::Pin;
using breakaway::firmware::Wiring;

struct Registers {
  std::map<std::uintptr_t, std::uint32_t> values;
  std::vector<std::pair<std::uintptr_t, std::uint32_t>> writes;
  std::uint32_t read(std::uintptr_t address) noexcept { return values[address]; }
  void write(std::uintptr_t address, std::uint32_t value) noexcept {
    values[address] = value;
    writes.emplace_back(address, value);
  }
};

constexpr std::uintptr_t ahb1_enable = 0x40023830, apb1_enable = 0x40023840;
constexpr std::uintptr_t gpio_b = 0x40020400, gpio_c = 0x40020800;

TEST(Pins, ConnectAPinAndLeaveItsNeighboursAlone) {
  Registers chip;
  chip.values[gpio_b] = 0xFFFFFFFF;
  connect_pin(chip, pin('B', 12), can_function);
  EXPECT_EQ(chip.values[ahb1_enable], 1U << 1);
  EXPECT_EQ(chip.values[gpio_b], 0xFEFFFFFFU) << "MODER: alternate function";
  EXPECT_EQ(chip.values[gpio_b + 0x24], 9U << 16) << "AFRH";
  connect_pin(chip, pin('B', 6), usart1_function);
  EXPECT_EQ(chip.values[gpio_b + 0x20], 7U << 24) << "AFRL";
}

TEST(Pins, DriveAPinToItsLevelBeforeItIsAnOutput) {
  for (const bool high : {false, true}) {
    Registers chip;
    drive_pin(chip, pin('C', 5), high);
    ASSERT_EQ(chip.writes.size(), 3U);
    EXPECT_EQ(chip.writes[0].first, ahb1_enable);
    EXPECT_EQ(chip.writes[1], (std::pair<std::uintptr_t, std::uint32_t>{gpio_c + 0x18, high ? 1U << 5 : 1U << 21}));
    EXPECT_EQ(chip.writes[2], (std::pair<std::uintptr_t, std::uint32_t>{gpio_c, 1U << 10}));
  }
  Registers chip;
  drive_pin(chip, Pin::none, true);
  EXPECT_TRUE(chip.writes.empty());
}

TEST(CanController, ReachesItsOwnRegistersAndTheCommonFilters) {
  Registers chip;
  CanController<1, Registers> first{chip};
  CanController<2, Registers> second{chip};
  first.write(0x1C, 1);
  second.write(0x1C, 2);
  second.write(0x240, 3);
  EXPECT_EQ(chip.values[0x4000641C], 1U);
  EXPECT_EQ(chip.values[0x4000681C], 2U);
  EXPECT_EQ(chip.values[0x40006640], 3U) << "the filters are the first controller's";
  EXPECT_EQ(second.read(0x240), 3U);
}

// RM0090, 12.2.
TEST(CanController, HasItsInterrupts) {
  Registers chip;
  CanController<1, Registers> first{chip};
  first.enable_interrupts();
  EXPECT_EQ(chip.writes[0], (std::pair<std::uintptr_t, std::uint32_t>{0xE000E100, 1U << 19}));
  EXPECT_EQ(chip.writes[1], (std::pair<std::uintptr_t, std::uint32_t>{0xE000E100, 1U << 20}));
  first.pend_transmit_interrupt();
  EXPECT_EQ(chip.writes[2], (std::pair<std::uintptr_t, std::uint32_t>{0xE000E200, 1U << 19}));
  CanController<2, Registers> second{chip};
  second.enable_interrupts();
  EXPECT_EQ(chip.writes[3], (std::pair<std::uintptr_t, std::uint32_t>{0xE000E104, 1U << 31}));
  EXPECT_EQ(chip.writes[4], (std::pair<std::uintptr_t, std::uint32_t>{0xE000E108, 1U << 0}));
  second.pend_transmit_interrupt();
  EXPECT_EQ(chip.writes[5], (std::pair<std::uintptr_t, std::uint32_t>{0xE000E204, 1U << 31}));
}

TEST(CanController, TheSecondNeedsTheFirstsClockAndTakesAllFilters) {
  Registers chip;
  chip.values[0x40006600] = 0x2A1C0E01;  // FMR after a reset: the second's banks begin at 14
  CanController<2, Registers> second{chip};
  second.connect({.can_controller = 2, .can_receive = pin('B', 5), .can_transmit = pin('B', 6)});
  EXPECT_EQ(chip.values[apb1_enable], 1U << 25 | 1U << 26);
  EXPECT_EQ(chip.values[0x40006600], 0x2A1C0001U);
  Registers other;
  other.values[0x40006600] = 0x2A1C0E01;
  CanController<1, Registers> first{other};
  first.connect(Wiring{});
  EXPECT_EQ(other.values[apb1_enable], 1U << 25);
  EXPECT_EQ(other.values[0x40006600], 0x2A1C0E01U) << "bank 0 is the first's";
}

TEST(CanController, WakesItsTransceiverBeforeItIsConnected) {
  Registers chip;
  CanController<1, Registers> first{chip};
  first.connect({.can_standby = pin('C', 5), .can_awake = false});
  std::size_t awake = 0, connected = 0;
  for (std::size_t i = 0; i < chip.writes.size(); ++i) {
    if (chip.writes[i].first == gpio_c) awake = i;
    if (chip.writes[i].first == gpio_b && connected == 0) connected = i;
  }
  EXPECT_GT(awake, 0U);
  EXPECT_GT(connected, awake);
  EXPECT_EQ(chip.values[gpio_c + 0x18], 1U << 21) << "low";
}

}  // namespace
