#include "realtime.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace {

using namespace std::chrono_literals;
using namespace breakaway::linux_node;

TEST(LinuxNodeTicker, NeverWakesEarlyAndKeepsItsGrid) {
  Ticker ticker{2ms};
  const auto woken = ticker.wait();
  const auto first = woken - ticker.last_latency();
  for (int n = 1; n <= 20; ++n) {
    const auto now = ticker.wait();
    EXPECT_GE(ticker.last_latency(), 0ns);
    EXPECT_EQ((now - ticker.last_latency() - first) % 2ms, 0ns);
  }
  EXPECT_EQ(ticker.latency().wakes, 21U);
}

TEST(LinuxNodeTicker, CountsTicksThatWereMissedAndLeavesThemOut) {
  Ticker ticker{2ms};
  ticker.wait();
  const auto missed_before = ticker.latency().missed;
  std::this_thread::sleep_for(11ms);
  ticker.wait();
  EXPECT_GE(ticker.latency().missed - missed_before, 4U);
}

TEST(LinuxNodeHeardTime, CountsALatePeriodForTwoAtMost) {
  constexpr breakaway::hal::Time begin{100s};
  HeardTime heard{2ms, begin};
  EXPECT_EQ(heard.passed(), 0ns);
  heard.pass_to(begin + 2ms);
  heard.pass_to(begin + 5ms);
  EXPECT_EQ(heard.passed(), 5ms);
  heard.pass_to(begin + 600s);
  EXPECT_EQ(heard.passed(), 9ms);
  heard.pass_to(begin + 600s + 2ms);
  EXPECT_EQ(heard.passed(), 11ms);
}

TEST(LinuxNodeLatency, KeepsLeastMeanAndWorst) {
  Latency latency;
  for (const auto value : {30us, 10us, 20us}) latency.add(value);
  EXPECT_EQ(latency.shortest, 10us);
  EXPECT_EQ(latency.mean(), 20us);
  EXPECT_EQ(latency.longest, 30us);
}

}  // namespace
