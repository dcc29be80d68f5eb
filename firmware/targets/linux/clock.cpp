#include "clock.hpp"

#include <chrono>
#include <ctime>

namespace breakaway::linux_node {

hal::Time monotonic_now() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return hal::Time{std::chrono::seconds{t.tv_sec} + hal::Duration{t.tv_nsec}};
}

hal::Time sleep_until(hal::Time time) noexcept {
  const hal::Duration due = time.time_since_epoch();
  const timespec until{.tv_sec = due / std::chrono::seconds{1}, .tv_nsec = (due % std::chrono::seconds{1}).count()};
  hal::Time now = monotonic_now();
  for (; now < time; now = monotonic_now()) clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
  return now;
}

}  // namespace breakaway::linux_node
