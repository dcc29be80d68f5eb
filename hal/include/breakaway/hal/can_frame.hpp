// A classic CAN data or remote frame (ISO 11898-1) with an 11-bit identifier, and its length on the wire.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

struct CanFrame {
  std::uint16_t id = 0;   // 0..0x7FF; the lower one wins arbitration
  std::uint8_t size = 0;  // data bytes, 0..8
  bool remote = false;    // remote transmission request: size is the requested length, no data on the wire
  std::array<std::uint8_t, 8> data{};

  constexpr std::span<const std::uint8_t> payload() const noexcept {
    return std::span{data}.first(size <= 8 ? size : 8);
  }
  friend constexpr bool operator==(const CanFrame&, const CanFrame&) = default;
};

// A frame as it was received, with the time of its last bit.
struct ReceivedFrame {
  CanFrame frame;
  Time time{};
};

}  // namespace breakaway::hal
