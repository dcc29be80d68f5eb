#include "breakaway/odrive/bus_budget.hpp"

#include <gtest/gtest.h>

namespace breakaway::odrive::test {
namespace {

using namespace std::chrono_literals;

constexpr Sampling polled{.estimates = Estimates::polled};

struct Row {
  unsigned axes, cyclic_us, cyclic_Hz, polled_us, polled_Hz;
};
// Worked by hand at 1 Mbit/s, where a message of 8 bytes takes 135 bits and a question 55: 135 for the one that is kept
// free, and for each axis 3 x 135, and 2 x 55 more where it is polled.
constexpr Row rows[] = {{0, 135, 7407, 135, 7407}, {1, 540, 1851, 650, 1538}, {2, 945, 1058, 1165, 858},
                        {3, 1350, 740, 1680, 595}, {4, 1755, 569, 2195, 455}, {8, 3375, 296, 4255, 235}};

TEST(OdriveBusBudget, GivesTheTimeAndTheRateOfCyclicAndOfPolledAxes) {
  for (const Row& row : rows) {
    const BusBudget cyclic = bus_budget(row.axes, 1ms, 1'000'000, {}),
                    asked = bus_budget(row.axes, 1ms, 1'000'000, polled);
    EXPECT_EQ(cyclic.needed_us, row.cyclic_us) << row.axes;
    EXPECT_EQ(cyclic.max_rate_Hz, row.cyclic_Hz) << row.axes;
    EXPECT_EQ(asked.needed_us, row.polled_us) << row.axes;
    EXPECT_EQ(asked.max_rate_Hz, row.polled_Hz) << row.axes;
  }
}

// A period that is no whole number of theirs may see one more of them.
TEST(OdriveBusBudget, CountsCyclicSamplesAsOftenAsTheyMayComeInAPeriod) {
  const auto needed_us = [](hal::Duration period, hal::Duration each) {
    return bus_budget(1, period, 1'000'000, {.estimate_period = each}).needed_us;
  };
  EXPECT_EQ(needed_us(1ms, 500us), 135U * (1 + 1 + 2 * 2));
  EXPECT_EQ(needed_us(1ms, 400us), 135U * (1 + 1 + 2 * 3));
  EXPECT_EQ(needed_us(1ms, 1ms - 1ns), 135U * (1 + 1 + 2 * 2));
  EXPECT_EQ(bus_budget(1, 2ms, 1'000'000, {}).needed_us, 135U * (1 + 1 + 2 * 2)) << "every millisecond unless told";
}

TEST(OdriveBusBudget, KeepsSoManyFramesFree) {
  EXPECT_EQ(bus_budget(2, 1ms, 1'000'000, {}, 0).needed_us, 810U);
  EXPECT_EQ(bus_budget(2, 1ms, 1'000'000, {}, 3).needed_us, 1215U);
}

TEST(OdriveBusBudget, RoundsTheNeedUpAndWhatThereIsDown) {
  EXPECT_EQ(bus_budget(1, 1ms, 500'000, {}).needed_us, 1080U);
  EXPECT_EQ(bus_budget(1, 1ms, 300'000, {}).needed_us, 1800U);
  EXPECT_EQ(bus_budget(1, 1ms, 700'000, {}).needed_us, 772U) << "771.4";
  EXPECT_EQ(bus_budget(1, 1ms, 999'999, {}).needed_us, 541U) << "540.0005";
  EXPECT_EQ(bus_budget(1, 1ms, 700'000, {}).max_rate_Hz, 1296U) << "1296.3";
  EXPECT_EQ(bus_budget(1, 1'999ns, 1'000'000, {}).available_us, 1U);
  EXPECT_EQ(bus_budget(1, 1ms, 1'000'000, {}).available_us, 1000U);
}

TEST(OdriveBusBudget, FitsWhereAPeriodIsJustEnough) {
  EXPECT_TRUE(bus_budget(1, 650us, 1'000'000, polled).fits());
  EXPECT_FALSE(bus_budget(1, 649us, 1'000'000, polled).fits());
  EXPECT_TRUE(bus_budget(2, 1ms, 1'000'000, {}).fits());
  EXPECT_FALSE(bus_budget(3, 1ms, 1'000'000, {}).fits());
}

TEST(OdriveBusBudget, OfNothingIsNothing) {
  const BusBudget none;
  EXPECT_EQ(none.needed_us, 0U);
  EXPECT_EQ(none.available_us, 0U);
  EXPECT_EQ(none.max_rate_Hz, 0U);
}

}  // namespace
}  // namespace breakaway::odrive::test
