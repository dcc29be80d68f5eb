// What makes a process of Linux keep its periods: memory that stays, a priority, absolute wake-ups.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

#include "breakaway/hal/time.hpp"
#include "clock.hpp"

namespace breakaway::linux_node {

// Locks all memory, present and future, touches the stack, and gives the calling thread the priority (SCHED_FIFO, 1 to
// 99). Empty, or what is not permitted with the remedy.
std::string become_realtime(int priority);

// Gives the calling thread its usual priority back at the end of its life: to report, to end by an exception and to
// free locked memory take longer than a period, which another node on this processor would have to wait for.
class RealtimeScope {
 public:
  RealtimeScope() = default;
  ~RealtimeScope();
  RealtimeScope(const RealtimeScope&) = delete;
  RealtimeScope& operator=(const RealtimeScope&) = delete;
};

struct Latency {
  hal::Duration shortest{};
  hal::Duration longest{};
  hal::Duration sum{};
  std::uint64_t wakes = 0;
  std::uint64_t missed = 0;  // periods that had passed already at a wake-up

  void add(hal::Duration latency) noexcept {
    shortest = wakes == 0 ? latency : std::min(shortest, latency);
    longest = std::max(longest, latency);
    sum += latency;
    ++wakes;
  }
  hal::Duration mean() const noexcept { return wakes == 0 ? sum : sum / static_cast<std::int64_t>(wakes); }
};

// The time in which others could be heard. A period that came late counts for two at most: what they said in it was not
// heard, and what they were to be told was not said.
class HeardTime {
 public:
  HeardTime(hal::Duration period, hal::Time begin) noexcept : period_{period}, last_{begin} {}

  // Once a period.
  void pass_to(hal::Time now) noexcept {
    passed_ += std::min(now - last_, 2 * period_);
    last_ = now;
  }
  hal::Duration passed() const noexcept { return passed_; }

 private:
  hal::Duration period_;
  hal::Time last_;
  hal::Duration passed_{};
};

// Wakes at start + n periods. A period that was missed is left out, not made up for.
class Ticker {
 public:
  explicit Ticker(hal::Duration period) noexcept : period_{period}, next_{monotonic_now() + period} {}

  // Sleeps until the next tick; returns the time then.
  hal::Time wait() noexcept;
  // Sleeps until so long after the newest tick was due; returns the time then. What latency() says is of the ticks.
  hal::Time wait_within(hal::Duration after_tick) const noexcept;
  const Latency& latency() const noexcept { return latency_; }
  hal::Duration last_latency() const noexcept { return last_; }
  // Whether the newest tick was reached before the one after it was due.
  bool in_time() const noexcept { return last_ < period_; }

 private:
  hal::Duration period_;
  hal::Time next_;
  hal::Time tick_{};  // when the newest was due
  hal::Duration last_{};
  Latency latency_;
};

}  // namespace breakaway::linux_node
