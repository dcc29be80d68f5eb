#include "realtime.hpp"

#include <fmt/format.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace breakaway::linux_node {
namespace {

// Pages that the loop may come to use are there before it starts.
void touch_stack() noexcept {
  constexpr std::size_t page = 4096;
  std::array<std::byte, 64 * page> room;
  volatile std::byte* first = room.data();
  for (std::size_t at = 0; at < room.size(); at += page) first[at] = std::byte{0};
}

}  // namespace

std::string become_realtime(int priority) {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return fmt::format(
        "memory cannot be locked ({}): run as root, or allow it in /etc/security/limits.d (`@realtime - memlock "
        "unlimited`); --no-realtime tries without",
        std::strerror(errno));
  }
  touch_stack();
  const sched_param wanted{.sched_priority = priority};
  if (sched_setscheduler(0, SCHED_FIFO, &wanted) == 0) return {};
  return fmt::format(
      "no real-time priority ({}): run as root, or grant CAP_SYS_NICE (`setcap cap_sys_nice,cap_ipc_lock+ep "
      "breakaway-node`) or `@realtime - rtprio 99` in /etc/security/limits.d; --no-realtime tries without",
      std::strerror(errno));
}

RealtimeScope::~RealtimeScope() {
  const sched_param usual{.sched_priority = 0};
  static_cast<void>(sched_setscheduler(0, SCHED_OTHER, &usual));
}

hal::Time Ticker::wait() noexcept {
  const hal::Time now = sleep_until(next_);
  last_ = now - next_;
  latency_.add(last_);
  const std::int64_t passed = last_ / period_;
  latency_.missed += static_cast<std::uint64_t>(passed);
  tick_ = next_ + period_ * passed;
  next_ = tick_ + period_;
  return now;
}

hal::Time Ticker::wait_within(hal::Duration after_tick) const noexcept { return sleep_until(tick_ + after_tick); }

}  // namespace breakaway::linux_node
