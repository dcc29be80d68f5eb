// Bit timing of the bxCAN controller (RM0090, 32.7.7).
#pragma once

#include <cstdint>
#include <optional>

namespace breakaway::bxcan {

// A bit is 1 + segment1 + segment2 quanta of prescaler clock cycles, sampled at the end of segment 1.
struct BitTiming {
  std::uint32_t prescaler = 1;  // 1..1024
  std::uint32_t segment1 = 1;   // 1..16
  std::uint32_t segment2 = 1;   // 1..8; resynchronisation may shift by one quantum

  constexpr std::uint32_t quanta() const noexcept { return 1 + segment1 + segment2; }
  constexpr std::uint32_t register_value() const noexcept {
    return (segment2 - 1) << 20 | (segment1 - 1) << 16 | (prescaler - 1);
  }
};

// Exactly this bit rate from this clock, sampled as near to 87.5 % of the bit as can be (CiA 301, table 1), with 8 to
// 25 quanta; nothing when no divisor makes it.
std::optional<BitTiming> bit_timing(std::uint32_t clock_Hz, std::uint32_t bit_rate) noexcept;

}  // namespace breakaway::bxcan
