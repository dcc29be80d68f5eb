#include "breakaway/hal/time.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>

#include "breakaway/hal/clock.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::hal::Duration;
using breakaway::hal::seconds;
using breakaway::hal::Time;

template <class A, class B>
concept Addable = requires(A a, B b) {
  a + b;
};
template <class A, class B>
concept Comparable = requires(A a, B b) {
  a < b;
};
template <class A, class B>
concept Assignable = requires(A a, B b) {
  a = b;
};

// A point in time and a duration are not taken for one another.
static_assert(!std::convertible_to<Duration, Time> && !std::convertible_to<Time, Duration>);
static_assert(!Assignable<Time&, Duration> && !Assignable<Duration&, Time>);
static_assert(!Comparable<Time, Duration> && !Comparable<Duration, Time>);
static_assert(!Addable<Time, Time>);
static_assert(!std::convertible_to<std::chrono::steady_clock::time_point, Time>);
static_assert(!std::is_invocable_v<void (*)(Time), Duration> && !std::is_invocable_v<void (*)(Duration), Time>);

// What means something compiles.
static_assert(Addable<Time, Duration> && Comparable<Time, Time> && Assignable<Time&, Time>);
static_assert(std::same_as<decltype(Time{} - Time{}), Duration>);
static_assert(std::same_as<decltype(Time{} + 1ms), Time>);
static_assert(Time{1s} + 500ms - Time{} == 1500ms);

// Both are 64 bits of nanoseconds, as cheap to pass as a number.
static_assert(sizeof(Time) == 8 && std::is_trivially_copyable_v<Time> && Time::clock::is_steady);

static_assert(seconds(Duration{1'500'000'000}) == 1.5);
static_assert(seconds(Time{250ms}) == 0.25);

struct TestClock {
  Time now() const noexcept { return Time{1s}; }
};
struct ClockOfDurations {
  Duration now() const noexcept { return 1s; }
};
struct ClockThatMayThrow {
  Time now() const { return Time{1s}; }
};
static_assert(breakaway::hal::Clock<TestClock>);
static_assert(!breakaway::hal::Clock<ClockOfDurations>);
static_assert(!breakaway::hal::Clock<ClockThatMayThrow>);

TEST(Time, SecondsAreThoseOfTheNanoseconds) {
  for (const std::int64_t count : {0LL, 1LL, -1LL, 999'999'999LL, 86'400'000'000'000LL}) {
    EXPECT_DOUBLE_EQ(seconds(Duration{count}), static_cast<double>(count) * 1e-9);
    EXPECT_EQ(seconds(Time{Duration{count}}), seconds(Duration{count}));
  }
}

// What a conversion of all 64 bits gives, by one rounding at most; exactly that where they fit into the mantissa or are
// less than two seconds, as periods are.
TEST(SecondsAs, AgreesWithAConversionOfAllBits) {
  for (const std::int64_t ns : {0LL, 1LL, -1LL, 1'000'000LL, -1'000'001LL, 2'147'483'647LL, 2'147'483'648LL,
                                -2'147'483'648LL, -2'147'483'649LL, 86'400'000'000'001LL, -315'360'000'000'000'007LL}) {
    const Duration duration{ns};
    EXPECT_EQ(breakaway::hal::seconds_as<double>(duration), static_cast<double>(ns) * 1e-9) << ns;
    const float expected = static_cast<float>(ns) * 1e-9F;
    const bool is_exact = ns >= 0 && ns < 1LL << 31;
    const float tolerance = is_exact ? 0 : 2e-7F * std::max(std::abs(expected), ns < 0 ? 2.0F : 0.0F);
    EXPECT_NEAR(breakaway::hal::seconds_as<float>(duration), expected, tolerance) << ns;
  }
}

}  // namespace
