#include "breakaway/canopen/bus_budget.hpp"

#include <gtest/gtest.h>

namespace {

using namespace std::chrono_literals;
using breakaway::canopen::AcyclicTraffic;
using breakaway::canopen::bus_budget;
using breakaway::canopen::BusFit;
using breakaway::canopen::check_bus_budget;
using breakaway::canopen::sync_offset;

struct Row {
  unsigned axes, cycle_us, max_rate_Hz, max_rate_with_acyclic_Hz;
};
// Worked by hand at 1 Mbit/s: 55 + axes x (95 + 135) bits, and 135 more with one 8-byte frame kept free.
constexpr Row rows[] = {{1, 285, 3508, 2380}, {2, 515, 1941, 1538}, {3, 745, 1342, 1136}, {4, 975, 1025, 900},
                        {5, 1205, 829, 746},  {6, 1435, 696, 636},  {7, 1665, 600, 555},  {8, 1895, 527, 492}};

TEST(BusBudget, GivesTheCycleAndRateOfOneToEightAxes) {
  for (const Row& row : rows) {
    const auto bare = bus_budget(row.axes, 1ms, 1'000'000, {.frames = 0});
    EXPECT_EQ(bare.needed_us, row.cycle_us) << row.axes;
    EXPECT_EQ(bare.max_rate_Hz, row.max_rate_Hz) << row.axes;
    EXPECT_EQ(bus_budget(row.axes, 1ms, 1'000'000).max_rate_Hz, row.max_rate_with_acyclic_Hz) << row.axes;
  }
}

TEST(BusBudget, TellsThePeriodThatTheAxesNeed) {
  EXPECT_EQ(check_bus_budget(3, 1ms, 1'000'000), BusFit::fits);  // 880 us
  EXPECT_EQ(check_bus_budget(4, 1ms, 1'000'000), BusFit::overloaded);
  const auto budget = bus_budget(4, 1ms, 1'000'000);
  EXPECT_EQ(budget.needed_us, 975U + 135U);
  EXPECT_EQ(budget.least_period, 1110us);
  EXPECT_EQ(budget.available_us, 1000U);
  EXPECT_EQ(budget.max_axes, 3U);
}

TEST(BusBudget, AcceptsExactlyWhatFits) {
  for (unsigned axes = 1; axes <= 8; ++axes)
    for (const std::uint32_t bit_rate : {125'000U, 250'000U, 500'000U, 1'000'000U}) {
      const auto least = bus_budget(axes, 1ms, bit_rate).least_period;
      EXPECT_EQ(least % 1us, 0ns);
      EXPECT_EQ(check_bus_budget(axes, least, bit_rate), BusFit::fits) << axes << " at " << bit_rate;
      EXPECT_EQ(check_bus_budget(axes, least - 1us, bit_rate), BusFit::overloaded) << axes << " at " << bit_rate;
    }
}

TEST(BusBudget, HalfTheBitRateNeedsTwiceTheTime) {
  EXPECT_EQ(bus_budget(1, 1ms, 500'000).needed_us, 2 * bus_budget(1, 1ms, 1'000'000).needed_us);
}

TEST(BusBudget, HeartbeatsThatMustPassInOnePeriodCountToo) {
  const AcyclicTraffic traffic{.frames = 1, .heartbeats = 2};
  EXPECT_EQ(bus_budget(1, 1ms, 1'000'000, traffic).needed_us, 285U + 135U + 2U * 65U);
}

TEST(BusBudget, TakesTheWholeOfEachRange) {
  EXPECT_EQ(check_bus_budget(127, 1h, 1'000'000), BusFit::fits);
  EXPECT_EQ(check_bus_budget(1, 1h, 10'000), BusFit::fits);
  EXPECT_EQ(bus_budget(1, 1h, 1'000'000).max_axes, 127U) << "there are no more node ids";
  EXPECT_EQ(bus_budget(1, 127 * 230us + 190us, 1'000'000).max_axes, 127U);
  EXPECT_EQ(bus_budget(1, 127 * 230us + 189us, 1'000'000).max_axes, 126U);
  EXPECT_EQ(bus_budget(1, 189us, 1'000'000).max_axes, 0U) << "less than what every period needs";
  const auto nothing = bus_budget(0, 1ms, 1'000'000);
  EXPECT_EQ(nothing.needed_us + nothing.available_us + nothing.max_axes + nothing.max_rate_Hz, 0U);
}

TEST(BusBudget, SyncWaitsForTheLongestCommandsAndForTheStepThatComputesThem) {
  EXPECT_EQ(sync_offset(1, 1ms, 1'000'000), 95us + 50us) << "a twentieth of the period for the step";
  EXPECT_EQ(sync_offset(3, 1ms, 1'000'000), 3 * 95us + 50us);
  EXPECT_EQ(sync_offset(1, 1ms, 500'000), 190us + 50us);
  EXPECT_EQ(sync_offset(1, 10ms, 1'000'000), 95us + 100us) << "no step takes longer than that";
  const auto full = bus_budget(3, 10ms, 1'000'000).least_period;
  EXPECT_EQ(sync_offset(3, full + 20us, 1'000'000), 3 * 95us + 10us) << "half of the room that is left";
  EXPECT_EQ(sync_offset(3, full, 1'000'000), 3 * 95us);
  EXPECT_EQ(sync_offset(3, full - 1us, 1'000'000), 0us) << "they do not fit";
}

TEST(BusBudget, NamesTheParameterThatIsOutOfRange) {
  EXPECT_EQ(check_bus_budget(0, 1ms, 1'000'000), BusFit::axes_out_of_range);
  EXPECT_EQ(check_bus_budget(128, 1ms, 1'000'000), BusFit::axes_out_of_range);
  EXPECT_EQ(check_bus_budget(1, 0ms, 1'000'000), BusFit::period_out_of_range);
  EXPECT_EQ(check_bus_budget(1, 1h + 1ns, 1'000'000), BusFit::period_out_of_range);
  EXPECT_EQ(check_bus_budget(1, 1ms, 9'999), BusFit::bit_rate_out_of_range);
  EXPECT_EQ(check_bus_budget(1, 1ms, 1'000'001), BusFit::bit_rate_out_of_range);
  EXPECT_EQ(bus_budget(1, 1ms, 0).least_period, 0ns) << "no figures for what is out of range";
}

}  // namespace
