// TimingStatistics: when the loop ran, and when it should have.
#pragma once

#include <cstdint>

#include "breakaway/hal/time.hpp"

namespace breakaway::firmware {

class TimingStatistics {
 public:
  constexpr explicit TimingStatistics(hal::Duration period) noexcept : period_{period} {}

  // A step starts at `now`. A period in which no step started counts as a missed tick.
  constexpr void begin(hal::Time now) noexcept {
    if (ticks_ > 0) {
      const hal::Duration interval = now - last_;
      if (ticks_ == 1 || interval < shortest_) shortest_ = interval;
      if (interval > longest_) longest_ = interval;
      // To the nearest period. It is divided only when a period was missed.
      if (interval >= 2 * period_ - period_ / 2)
        missed_ += static_cast<std::uint64_t>((interval + period_ / 2) / period_ - 1);
    }
    last_ = now;
    ++ticks_;
  }

  constexpr std::uint64_t ticks() const noexcept { return ticks_; }
  constexpr std::uint64_t missed_ticks() const noexcept { return missed_; }
  constexpr hal::Duration shortest_interval() const noexcept { return shortest_; }
  constexpr hal::Duration longest_interval() const noexcept { return longest_; }

 private:
  hal::Duration period_;
  hal::Time last_{};
  hal::Duration shortest_{};
  hal::Duration longest_{};
  std::uint64_t ticks_ = 0;
  std::uint64_t missed_ = 0;
};

}  // namespace breakaway::firmware
