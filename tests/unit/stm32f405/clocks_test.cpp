#include "clocks.hpp"

#include <gtest/gtest.h>

#include "chip_model.hpp"

namespace {

using breakaway::stm32f405::Clocks;
using breakaway::stm32f405::ClockTree;
using breakaway::stm32f405::Crystal;
using breakaway::stm32f405_test::ChipModel;

// Over all temperatures the internal oscillator is this far off (data sheet, table 41).
constexpr double slowest = 0.92, fastest = 1.045;

Clocks start(ChipModel& chip, std::uint32_t crystal_Hz) { return ClockTree{chip}.start(crystal_Hz); }

void expect_internal(const Clocks& clocks, const ChipModel& chip) {
  EXPECT_EQ(clocks.core_Hz, 16'000'000U);
  EXPECT_EQ(clocks.apb1_Hz, 16'000'000U);
  EXPECT_EQ(chip.core_Hz(), chip.internal_Hz);
  EXPECT_FALSE(chip.pll_is_on() || chip.crystal_is_on()) << "nothing is left on that runs nothing";
}

TEST(Clocks, RunsFromEveryCrystalAtEveryTemperature) {
  for (std::uint32_t mega = 4; mega <= 26; ++mega) {
    for (const double off : {slowest, 1.0, fastest}) {
      ChipModel chip;
      chip.crystal_Hz = mega * 1e6;
      chip.internal_Hz = off * 16e6;
      const Clocks clocks = start(chip, mega * 1'000'000);
      ASSERT_EQ(clocks.crystal, Crystal::runs) << mega << " MHz";
      EXPECT_EQ(clocks.core_Hz, 168'000'000U);
      EXPECT_NEAR(chip.core_Hz(), 168e6, 1);
      EXPECT_TRUE(chip.crystal_watched());
      EXPECT_EQ(chip.value(ChipModel::apb2_enable), 0U) << "the timer is left without a clock";
    }
  }
}

// Of all pairs that are a fifth apart; in between it depends on the temperature.
TEST(Clocks, NeverRunsThePllFromACrystalThatIsAnotherThanStated) {
  for (std::uint32_t stated = 4; stated <= 26; ++stated) {
    for (std::uint32_t fitted = 3; fitted <= 50; ++fitted) {
      if (fitted * 10 > stated * 8 && fitted * 10 < stated * 12) continue;
      for (const double off : {slowest, fastest}) {
        ChipModel chip;
        chip.crystal_Hz = fitted * 1e6;
        chip.internal_Hz = off * 16e6;
        const Clocks clocks = start(chip, stated * 1'000'000);
        ASSERT_EQ(clocks.crystal, Crystal::wrong_frequency) << fitted << " for " << stated << " MHz";
        EXPECT_FALSE(chip.pll_ran);
        expect_internal(clocks, chip);
      }
    }
  }
}

TEST(Clocks, KeepsThePllInItsRangeWhateverCrystalPasses) {
  for (double fitted_Hz = 6e6; fitted_Hz < 10.5e6; fitted_Hz += 0.05e6) {
    for (const double off : {slowest, fastest}) {
      ChipModel chip;  // which knows the range
      chip.crystal_Hz = fitted_Hz;
      chip.internal_Hz = off * 16e6;
      start(chip, 8'000'000);
    }
  }
}

TEST(Clocks, StaysOnTheInternalOscillatorWithoutACrystal) {
  ChipModel chip;
  chip.crystal_Hz = 0;
  const Clocks clocks = start(chip, 8'000'000);
  EXPECT_EQ(clocks.crystal, Crystal::none);
  expect_internal(clocks, chip);
  EXPECT_LT(chip.time_s(), 0.25);
}

TEST(Clocks, RefusesACrystalThatIsReadyAndHasNoEdges) {
  ChipModel chip;
  chip.crystal_has_edges = false;
  const Clocks clocks = start(chip, 8'000'000);
  EXPECT_EQ(clocks.crystal, Crystal::wrong_frequency);
  expect_internal(clocks, chip);
  EXPECT_LT(chip.time_s(), 0.25);
}

TEST(Clocks, NamesAPllThatDoesNotLock) {
  ChipModel chip;
  chip.pll_locks = false;
  const Clocks clocks = start(chip, 8'000'000);
  EXPECT_EQ(clocks.crystal, Crystal::no_lock);
  expect_internal(clocks, chip);
  EXPECT_LT(chip.time_s(), 0.25);
}

}  // namespace
