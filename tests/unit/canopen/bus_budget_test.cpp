#include "breakaway/canopen/bus_budget.hpp"

#include <gtest/gtest.h>

namespace {

using namespace std::chrono_literals;
using breakaway::canopen::AcyclicTraffic;
using breakaway::canopen::bus_budget;
using breakaway::canopen::check_bus_budget;
using breakaway::hal::StatusCode;

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

TEST(BusBudget, RefusesWithTheMicrosecondsThatItNeeds) {
  EXPECT_TRUE(check_bus_budget(3, 1ms, 1'000'000).ok());  // 880 us
  const auto status = check_bus_budget(4, 1ms, 1'000'000);
  EXPECT_EQ(status.code, StatusCode::bus_overload);
  EXPECT_EQ(status.detail, 975U + 135U);
  const auto budget = bus_budget(4, 1ms, 1'000'000);
  EXPECT_EQ(budget.available_us, 1000U);
  EXPECT_EQ(budget.max_axes, 3U);
}

TEST(BusBudget, AcceptsExactlyWhatFits) {
  for (unsigned axes = 1; axes <= 8; ++axes)
    for (const std::uint32_t bit_rate : {125'000U, 250'000U, 500'000U, 1'000'000U}) {
      const auto needed = std::chrono::microseconds{bus_budget(axes, 1ms, bit_rate).needed_us};
      EXPECT_TRUE(check_bus_budget(axes, needed, bit_rate).ok()) << axes << " at " << bit_rate;
      EXPECT_FALSE(check_bus_budget(axes, needed - 1us, bit_rate).ok()) << axes << " at " << bit_rate;
    }
}

TEST(BusBudget, HalfTheBitRateNeedsTwiceTheTime) {
  EXPECT_EQ(bus_budget(1, 1ms, 500'000).needed_us, 2 * bus_budget(1, 1ms, 1'000'000).needed_us);
}

TEST(BusBudget, HeartbeatsThatMustPassInOnePeriodCountToo) {
  const AcyclicTraffic traffic{.frames = 1, .heartbeats = 2};
  EXPECT_EQ(bus_budget(1, 1ms, 1'000'000, traffic).needed_us, 285U + 135U + 2U * 65U);
}

TEST(BusBudget, NamesTheParameterThatIsOutOfRange) {
  EXPECT_EQ(check_bus_budget(0, 1ms, 1'000'000).detail, 1U);
  EXPECT_EQ(check_bus_budget(1, 0ms, 1'000'000).detail, 2U);
  EXPECT_EQ(check_bus_budget(1, 1ms, 0).detail, 3U);
  EXPECT_EQ(check_bus_budget(1, 1ms, 0).code, StatusCode::invalid_argument);
}

}  // namespace
