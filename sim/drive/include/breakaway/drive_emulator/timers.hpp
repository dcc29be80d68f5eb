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
  void set(std::size_t timer, hal::Time due) {
    due_.at(timer) = due;
    first_known_ = false;
  }
  void cancel(std::size_t timer) {
    due_.at(timer).reset();
    first_known_ = false;
  }
  void cancel_all() {
    due_ = {};
    first_known_ = false;
  }
  std::optional<hal::Time> due(std::size_t timer) const { return due_.at(timer); }

  // Returns the timer that is due first, and of several at one time the one with the lowest number; nothing when none
  // is set.
  std::optional<std::size_t> first() const {
    if (!first_known_) find_first();
    return first_;
  }
  // Returns when that is; hal::Time::max() when none is set.
  hal::Time first_due() const {
    const auto timer = first();
    return timer ? *due_[*timer] : hal::Time::max();
  }

 private:
  void find_first() const {
    first_.reset();
    for (std::size_t timer = 0; timer < count; ++timer)
      if (due_[timer] && (!first_ || *due_[timer] < *due_[*first_])) first_ = timer;
    first_known_ = true;
  }

  std::array<std::optional<hal::Time>, count> due_{};
  mutable std::optional<std::size_t> first_;  // asked for far more often than a timer is set
  mutable bool first_known_ = false;
};

}  // namespace breakaway::drive_emulator
