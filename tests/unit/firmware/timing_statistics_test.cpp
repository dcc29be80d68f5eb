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

// From one and a half periods on, to the nearest period.
TEST(TimingStatistics, RoundsAnIntervalToTheNearestPeriod) {
  struct Row {
    hal::Duration interval;
    unsigned missed;
  };
  for (const Row& row : {Row{0ms, 0}, Row{400us, 0}, Row{1ms, 0}, Row{1500us - 1ns, 0}, Row{1500us, 1}, Row{2ms, 1},
                         Row{2499us, 1}, Row{2500us, 2}, Row{10ms, 9}, Row{10'400us, 9}}) {
    TimingStatistics statistics{1ms};
    statistics.begin(hal::Time{5ms});
    statistics.begin(hal::Time{5ms + row.interval});
    EXPECT_EQ(statistics.missed_ticks(), row.missed) << row.interval.count() << " ns";
  }
}

}  // namespace
}  // namespace breakaway::firmware
