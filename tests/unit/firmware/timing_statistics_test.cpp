#include "breakaway/firmware/timing_statistics.hpp"

#include <gtest/gtest.h>

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;

TEST(TimingStatistics, CountsPeriodsInWhichNoStepStarted) {
  TimingStatistics statistics{1ms};
  for (const auto now : {10ms, 11ms, 12ms, 15ms, 16ms}) statistics.begin(hal::Time{now});
  EXPECT_EQ(statistics.ticks(), 5U);
  EXPECT_EQ(statistics.missed_ticks(), 2U);
  EXPECT_EQ(statistics.longest_interval(), 3ms);
  EXPECT_EQ(statistics.shortest_interval(), 1ms);
}

TEST(TimingStatistics, TakesJitterBelowHalfAPeriodForOnTime) {
  TimingStatistics statistics{1ms};
  for (const auto now : {0us, 1400us, 2000us, 3000us}) statistics.begin(hal::Time{now});
  EXPECT_EQ(statistics.missed_ticks(), 0U);
  EXPECT_EQ(statistics.shortest_interval(), 600us);
  EXPECT_EQ(statistics.longest_interval(), 1400us);
}

}  // namespace
}  // namespace breakaway::firmware
