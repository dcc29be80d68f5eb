#include "reset_state.hpp"

#include <gtest/gtest.h>

#include "chip_model.hpp"
#include "clocks.hpp"
#include "reset_cause.hpp"

namespace {

using namespace breakaway::stm32f405;
using breakaway::stm32f405_test::ChipModel;

TEST(ResetState, LeavesTheClocksOfABootloader) {
  ChipModel chip;
  chip.run_from_pll();
  ASSERT_NE(chip.core_Hz(), chip.internal_Hz);
  reset_clocks(chip);
  EXPECT_EQ(chip.core_Hz(), chip.internal_Hz);
  EXPECT_EQ(chip.read(ChipModel::control), 0x83U) << "RM0090, 7.3.1, but for the factory's calibration";
  EXPECT_EQ(chip.read(ChipModel::configuration), 0U);
  EXPECT_EQ(chip.value(ChipModel::pll), 0x24003010U);
  EXPECT_EQ(chip.value(ChipModel::clock_interrupts), 0x9F0000U) << "all cleared, none enabled";
}

TEST(ResetState, TheClocksStartAfterABootloaderAsAfterAReset) {
  ChipModel chip;
  chip.run_from_pll();
  reset_clocks(chip);
  EXPECT_EQ(ClockTree{chip}.start(8'000'000).crystal, Crystal::runs);
  EXPECT_NEAR(chip.core_Hz(), 168e6, 1);
}

TEST(ResetState, IsOfNoHarmAfterAReset) {
  ChipModel chip;
  reset_clocks(chip);
  EXPECT_EQ(chip.read(ChipModel::control), 0x83U);
  EXPECT_LT(chip.time_s(), 1e-3);
}

TEST(ResetState, EndsInterruptsAndTakesTheVectors) {
  struct Log {
    std::map<std::uintptr_t, std::uint32_t> written;
    std::uint32_t read(std::uintptr_t address) noexcept { return written[address]; }
    void write(std::uintptr_t address, std::uint32_t value) noexcept { written[address] = value; }
  } chip;
  take_interrupts(chip, 0x0801'0000);
  EXPECT_EQ(chip.written[0xE000E010], 0U) << "SysTick";
  for (std::uintptr_t word = 0; word < 3; ++word) {
    EXPECT_EQ(chip.written[0xE000E180 + 4 * word], 0xFFFFFFFFU) << "ICER";
    EXPECT_EQ(chip.written[0xE000E280 + 4 * word], 0xFFFFFFFFU) << "ICPR";
  }
  EXPECT_EQ(chip.written[0xE000ED04], 1U << 25 | 1U << 27) << "ICSR";
  EXPECT_EQ(chip.written[0xE000ED08], 0x0801'0000U) << "VTOR";
}

TEST(ResetState, ResetsEveryPeripheralAndStopsItsClock) {
  struct Log {
    std::map<std::uintptr_t, std::uint32_t> now, ever;
    std::uint32_t read(std::uintptr_t address) noexcept { return now[address]; }
    void write(std::uintptr_t address, std::uint32_t value) noexcept {
      now[address] = value;
      ever[address] |= value;
    }
  } chip;
  for (const std::uintptr_t offset : {0x30U, 0x34U, 0x38U, 0x40U, 0x44U}) chip.now[0x40023800 + offset] = 0xFFFFFFFF;
  reset_peripherals(chip);
  for (const std::uintptr_t offset : {0x10U, 0x14U, 0x18U, 0x20U, 0x24U}) {
    EXPECT_EQ(chip.ever[0x40023800 + offset], 0xFFFFFFFFU);
    EXPECT_EQ(chip.now[0x40023800 + offset], 0U);
  }
  EXPECT_EQ(chip.now[0x40023830], 0x00100000U) << "RM0090, 7.3.10";
  for (const std::uintptr_t offset : {0x34U, 0x38U, 0x40U, 0x44U}) EXPECT_EQ(chip.now[0x40023800 + offset], 0U);
}

TEST(ResetCause, IsTheOneThatSaysMostAndIsForgotten) {
  constexpr std::uint32_t brown_out = 1U << 25, pin = 1U << 26, power = 1U << 27, software = 1U << 28,
                          watchdog = 1U << 29, window = 1U << 30, low_power = 1U << 31;
  const auto cause = [](std::uint32_t flags) {
    ChipModel chip;
    chip.write(ChipModel::status, flags | 1U);
    const ResetCause first = take_reset_cause(chip);
    EXPECT_EQ(take_reset_cause(chip), ResetCause::unknown);
    EXPECT_EQ(chip.value(ChipModel::status) & 1U, 1U) << "the rest of the register stays";
    return first;
  };
  EXPECT_EQ(cause(power | brown_out | pin | watchdog), ResetCause::power);
  EXPECT_EQ(cause(brown_out | pin), ResetCause::power);
  EXPECT_EQ(cause(watchdog | pin), ResetCause::watchdog);
  EXPECT_EQ(cause(window | pin), ResetCause::watchdog);
  EXPECT_EQ(cause(software | pin), ResetCause::software);
  EXPECT_EQ(cause(low_power | pin), ResetCause::low_power);
  EXPECT_EQ(cause(pin), ResetCause::pin);
  EXPECT_EQ(cause(0), ResetCause::unknown);
}

}  // namespace
