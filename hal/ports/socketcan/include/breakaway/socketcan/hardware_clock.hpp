// HardwareClock: brings the receive stamps of a CAN controller's own counter to the system's clock.
//
// A software stamp is late by the interrupt's latency and never early; a hardware stamp is exact, but on a clock of
// unknown origin. The smallest difference seen is therefore the offset between the two, and it may grow with the
// clocks' drift only.
#pragma once

#include <algorithm>

#include "breakaway/hal/time.hpp"

namespace breakaway::socketcan {

class HardwareClock {
 public:
  // Returns the hardware's stamp on the clock of the software's, which says when the kernel took the frame. The result
  // is never later than that, and as even as the hardware's stamps are.
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
  // A difference that is longer means that the counter began anew or wrapped.
  static constexpr hal::Duration longest_latency = std::chrono::milliseconds{100};

  hal::Duration offset_{};
  hal::Time last_{};
  bool known_ = false;
};

}  // namespace breakaway::socketcan
