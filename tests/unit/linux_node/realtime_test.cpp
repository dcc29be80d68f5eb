#include "realtime.hpp"

#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <thread>

namespace {

bool sleeps_are_refused = false;

}  // namespace

// In place of the C library's.
extern "C" int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (sleeps_are_refused) return ENOSYS;
  return syscall(SYS_clock_nanosleep, clock, flags, time, left) == 0 ? 0 : errno;
}

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

// As where a filter of system calls knows no clock_nanosleep.
TEST(LinuxNodeTicker, KeepsItsPeriodsWhereItIsNotLetSleep) {
  Ticker ticker{2ms};
  sleeps_are_refused = true;
  const auto begin = monotonic_now();
  for (int n = 0; n < 10; ++n) {
    const auto now = ticker.wait();
    EXPECT_GE(ticker.last_latency(), 0ns);
    EXPECT_GE(ticker.wait_within(500us) - now, 500us - ticker.last_latency());
  }
  EXPECT_GE(monotonic_now() - begin, 18ms);
  sleeps_are_refused = false;
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
