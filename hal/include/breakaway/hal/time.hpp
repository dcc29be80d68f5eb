// Time, as the hal, the firmware and the simulation count it: signed nanoseconds.
//
// A point in time and a duration are two types, so that only what means something compiles: a point plus a duration,
// the difference of two points, their order; not the sum of two points, nor a duration where a point is wanted. Each
// clock chooses its own epoch. Points of two clocks must not be mixed, which no type here prevents.
#pragma once

#include <chrono>
#include <cstdint>

namespace breakaway::hal {

using Duration = std::chrono::nanoseconds;

// TimeLine tells std::chrono::time_point what it wants to know of a clock. It has no now(): logic gets the time as an
// argument and never asks for it (clock.hpp).
struct TimeLine {
  using duration = Duration;
  using rep = Duration::rep;
  using period = Duration::period;
  using time_point = std::chrono::time_point<TimeLine>;
  static constexpr bool is_steady = true;
};

using Time = TimeLine::time_point;

constexpr double seconds(Duration duration) noexcept { return std::chrono::duration<double>{duration}.count(); }

// The same in a step's scalar type, by one rounding more at most; a negative one may be off by that of two seconds. In
// two halves, as a controller converts 32 bits by one instruction, and 64 by a routine of a hundred.
template <class Scalar>
constexpr Scalar seconds_as(Duration duration) noexcept {
  constexpr int bits = 31;
  constexpr auto half = std::int64_t{1} << bits;
  const auto high = static_cast<std::int32_t>(duration.count() >> bits);
  const auto low = static_cast<std::int32_t>(duration.count() & (half - 1));
  return (static_cast<Scalar>(high) * static_cast<Scalar>(half) + static_cast<Scalar>(low)) * Scalar(1e-9);
}

// Seconds since the clock's epoch.
constexpr double seconds(Time time) noexcept { return seconds(time.time_since_epoch()); }

}  // namespace breakaway::hal
