// A classic CAN data or remote frame (ISO 11898-1) with an 11-bit identifier.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

struct CanFrame {
  static constexpr std::uint16_t max_id = 0x7FF;
  static constexpr std::uint8_t max_size = 8;

  std::uint16_t id = 0;   // 0..max_id; the lower one wins arbitration
  std::uint8_t size = 0;  // data bytes, 0..max_size
  bool remote = false;    // a remote transmission request: `size` is the length asked for, and no data is on the wire
  std::array<std::uint8_t, max_size> data{};

  // A size above max_size counts as max_size, as a receiver takes it.
  constexpr std::span<const std::uint8_t> payload() const noexcept {
    return std::span{data}.first(size <= max_size ? size : max_size);
  }
  friend constexpr bool operator==(const CanFrame&, const CanFrame&) = default;
};

struct ReceivedFrame {
  CanFrame frame;
  Time time{};  // when the frame's last bit was on the wire, as exactly as the port knows
};

}  // namespace breakaway::hal
