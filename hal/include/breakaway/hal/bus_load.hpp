// BusLoad: the share of its bit rate that a bus spends on frames, for display.
//
// It counts the bits of the frames that it is given, stuff bits and intermission included, in windows of a tenth of a
// second one after the other, and shows the last whole one. Whoever gives it only the frames that he hears through a
// filter gets the share of these.
#pragma once

#include <chrono>
#include <cstdint>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/hal/wire_length.hpp"

namespace breakaway::hal {

class BusLoad {
 public:
  static constexpr Duration window = std::chrono::milliseconds{100};

  // `bit_rate`: in bit/s, above 0.
  constexpr explicit BusLoad(std::uint32_t bit_rate) noexcept : bit_rate_{bit_rate} {}

  // Takes a frame that was on the bus at `time`. One that is older than others before it counts with them.
  constexpr void add(const CanFrame& frame, Time time) noexcept {
    advance_to(time);
    busy_ += wire_time(wire_bits(frame), bit_rate_);
  }

  // Returns the share, from 0 to about 1, in the last whole window before `now`.
  constexpr double share(Time now) noexcept {
    advance_to(now);
    return static_cast<double>(shown_.count()) / static_cast<double>(window.count());
  }

 private:
  constexpr void advance_to(Time time) noexcept {
    if (time < begin_ + window) return;
    const bool next = time < begin_ + 2 * window;
    shown_ = next ? busy_ : Duration::zero();
    begin_ += (time - begin_) / window * window;
    busy_ = Duration::zero();
  }

  std::uint32_t bit_rate_;
  Time begin_{};
  Duration busy_{}, shown_{};
};

}  // namespace breakaway::hal
