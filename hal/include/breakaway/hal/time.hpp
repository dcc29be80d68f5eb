// Time, as the hal, the firmware and the simulation count it: signed nanoseconds.
//
// A point in time and a duration are two types, so that only what means something compiles: a point plus a duration,
// the difference of two points, their order; not the sum of two points, nor a duration where a point is wanted. Each
// clock chooses its own epoch. Points of two clocks must not be mixed, which no type here prevents.
#pragma once

#include <chrono>

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

// Seconds since the clock's epoch.
constexpr double seconds(Time time) noexcept { return seconds(time.time_since_epoch()); }

}  // namespace breakaway::hal
