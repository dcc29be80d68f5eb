// Timers: deadlines in simulated time, each under a name that is an enumerator counted from 0.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "breakaway/hal/time.hpp"

namespace breakaway::drive_emulator {

template <std::size_t count>
class Timers {
 public:
  void set(std::size_t timer, hal::Time due) { due_.at(timer) = due; }
  void cancel(std::size_t timer) { due_.at(timer).reset(); }
  void cancel_all() { due_ = {}; }
  std::optional<hal::Time> due(std::size_t timer) const { return due_.at(timer); }

  // Returns the timer that is due first, and of several at one time the one with the lowest number; nothing when none
  // is set.
  std::optional<std::size_t> first() const {
    std::optional<std::size_t> best;
    for (std::size_t timer = 0; timer < count; ++timer)
      if (due_[timer] && (!best || *due_[timer] < *due_[*best])) best = timer;
    return best;
  }

 private:
  std::array<std::optional<hal::Time>, count> due_{};
};

}  // namespace breakaway::drive_emulator
