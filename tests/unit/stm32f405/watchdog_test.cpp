#include "watchdog.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "chip_model.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::stm32f405::Watchdog;
using breakaway::stm32f405_test::ChipModel;

// Of its oscillator, over temperature and from chip to chip (data sheet, table 42).
constexpr double slowest_Hz = 17e3, fastest_Hz = 47e3;

// Until the chip is reset, from now on.
double until_reset_s(ChipModel& chip) {
  const double begin_s = chip.time_s();
  while (!chip.reset_by_watchdog && chip.time_s() < begin_s + 100) chip.pass(1e-5);
  return chip.time_s() - begin_s;
}

TEST(Stm32Watchdog, ResetsNotBeforeItsTimeoutAndSoonAfter) {
  for (const auto timeout : {30us, 3'000us, 300'000us, 340'000us}) {
    for (const double oscillator_Hz : {slowest_Hz, 32e3, fastest_Hz}) {
      ChipModel chip;
      chip.watchdog_Hz = oscillator_Hz;
      ASSERT_TRUE(Watchdog{chip}.start(timeout));
      const double time_s = until_reset_s(chip), timeout_s = breakaway::hal::seconds(timeout);
      EXPECT_GE(time_s, timeout_s);
      EXPECT_LE(time_s, 2.8 * timeout_s + 0.5e-3);
    }
  }
}

TEST(Stm32Watchdog, HoldsLongTimeoutsInLargerSteps) {
  for (const auto timeout : {1s, 3s, 22s}) {
    for (const double oscillator_Hz : {slowest_Hz, fastest_Hz}) {
      ChipModel chip;
      chip.watchdog_Hz = oscillator_Hz;
      ASSERT_TRUE(Watchdog{chip}.start(timeout));
      const double time_s = until_reset_s(chip), timeout_s = breakaway::hal::seconds(timeout);
      EXPECT_GE(time_s, timeout_s);
      EXPECT_LE(time_s, 2.81 * timeout_s);
    }
  }
}

TEST(Stm32Watchdog, DoesNotResetWhileItIsServedInTime) {
  ChipModel chip;
  chip.watchdog_Hz = fastest_Hz;
  Watchdog watchdog{chip};
  ASSERT_TRUE(watchdog.start(3ms));
  for (int period = 0; period < 1000; ++period) {
    chip.pass(2.9e-3);
    ASSERT_FALSE(chip.reset_by_watchdog) << period;
    watchdog.serve();
  }
  EXPECT_LT(until_reset_s(chip), 4e-3);
}

TEST(Stm32Watchdog, StandsStillWhileADebuggerHaltsTheCore) {
  ChipModel chip;
  ASSERT_TRUE(Watchdog{chip}.start(3ms));
  EXPECT_EQ(chip.value(0xE0042008), 1U << 12) << "DBGMCU_APB1_FZ";
}

TEST(Stm32Watchdog, RefusesWhatItsCounterDoesNotHoldAndLeavesItOff) {
  for (const auto timeout : {0s, -1s, 23s, 3600s}) {
    ChipModel chip;
    EXPECT_FALSE(Watchdog{chip}.start(timeout));
    chip.pass(100);
    EXPECT_FALSE(chip.reset_by_watchdog);
  }
}

TEST(Stm32Watchdog, SaysWhenItsOscillatorDoesNotRun) {
  ChipModel chip;
  chip.watchdog_Hz = 1e-3;
  EXPECT_FALSE(Watchdog{chip}.start(3ms));
}

}  // namespace
