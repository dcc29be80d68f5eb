// Receive stamps of a CAN controller's own counter, brought to the system's clock.
//
// A software stamp is late by the interrupt's latency, never early; a hardware stamp is exact on a clock of unknown
// origin. So the smallest difference seen is the offset between the two, and it may grow with the clocks' drift only.
#pragma once

#include <algorithm>

#include "breakaway/hal/time.hpp"

namespace breakaway::socketcan {

class HardwareClock {
 public:
  // software: when the kernel took the frame, on the clock that is wanted. The result is never later than that, and as
  // even as the hardware's stamps are.
  hal::Time align(hal::Time hardware, hal::Time software) noexcept {
    const hal::Duration difference = software - hardware;
    const hal::Duration passed = hardware - last_;
    const bool counts_on = known_ && passed >= hal::Duration::zero() && difference - offset_ < longest_latency;
    offset_ = counts_on ? std::min(difference, offset_ + passed / drift_divisor) : difference;
    last_ = hardware;
    known_ = true;
    return hardware + offset_;
  }

 private:
  static constexpr std::int64_t drift_divisor = 5000;  // 200 ppm: two crystals of 100 ppm each
  // Beyond it the counter began anew, or wrapped.
  static constexpr hal::Duration longest_latency = std::chrono::milliseconds{100};

  hal::Duration offset_{};
  hal::Time last_{};
  bool known_ = false;
};

}  // namespace breakaway::socketcan
