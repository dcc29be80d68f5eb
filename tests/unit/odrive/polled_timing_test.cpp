#include "breakaway/odrive/polled_timing.hpp"

#include <gtest/gtest.h>

namespace breakaway::odrive::test {
namespace {

using namespace std::chrono_literals;

// Of one axis at 1 Mbit/s: a command without a stuff bit, and 135 + 135 + 55 us of command, heartbeat and question.
TEST(PolledTiming, CountsWhatMayBeBeforeAFrameOnTheWire) {
  const PolledTiming one = polled_timing(1, 1'000'000);
  EXPECT_EQ(one.first, 111us);
  EXPECT_EQ(one.last, 325us + drive_cycle);
  EXPECT_EQ(one.jitter(), 339us);
  EXPECT_EQ(one.answered, 840us + drive_cycle);
}

// The earlier axis' two questions and their answers come first.
TEST(PolledTiming, OfAnotherAxisIsLaterByAllThatTheFirstHas) {
  const hal::Duration more = polled_timing(2, 1'000'000).last - polled_timing(1, 1'000'000).last;
  EXPECT_EQ(more, 2 * 135us + 2 * (55us + 135us));
}

TEST(PolledTiming, GrowsWithTheBitTimeAndTheHeartbeats) {
  EXPECT_EQ(polled_timing(1, 500'000).last, 650us + drive_cycle);
  EXPECT_EQ(polled_timing(1, 1'000'000, 3).last - polled_timing(1, 1'000'000).last, 270us);
}

}  // namespace
}  // namespace breakaway::odrive::test
