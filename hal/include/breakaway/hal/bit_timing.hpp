// Bit timing of the common kind of CAN controller: a bit is 1 + segment1 + segment2 quanta, each of `prescaler` clock
// cycles, and is sampled at the end of segment 1. The port of a controller lays this out for its registers.
#pragma once

#include <cstdint>
#include <optional>

namespace breakaway::hal {

struct BitTiming {
  std::uint32_t prescaler = 1;  // from 1
  std::uint32_t segment1 = 1;   // 1..16
  std::uint32_t segment2 = 1;   // 1..8; resynchronisation may shift a bit by one quantum

  constexpr std::uint32_t quanta() const noexcept { return 1 + segment1 + segment2; }
};

namespace internal {

// Returns how far the sample point lies from 7/8 of the bit, in eighths of a quantum. Divided by `quanta` it is the
// part of a bit, so two timings are compared as fractions.
constexpr std::uint32_t sample_point_miss(std::uint32_t quanta, std::uint32_t segment2) noexcept {
  const std::uint32_t eighths = 8 * segment2;
  return eighths > quanta ? eighths - quanta : quanta - eighths;
}

}  // namespace internal

// Finds the timing that makes exactly this bit rate of this clock with 8 to 25 quanta and samples as near to 87.5 % of
// the bit as can be. Returns nothing when no divisor makes the rate, or only with a sample point outside the 85 to 90 %
// of CiA 301, table 1.
constexpr std::optional<BitTiming> bit_timing(std::uint32_t clock_Hz, std::uint32_t bit_rate,
                                              std::uint32_t largest_prescaler) noexcept {
  if (bit_rate == 0) return {};
  std::optional<BitTiming> best;
  std::uint32_t best_miss = 0;
  for (std::uint32_t quanta = 25; quanta >= 8; --quanta) {
    const std::uint64_t rate = std::uint64_t{quanta} * bit_rate;
    if (rate > clock_Hz || clock_Hz % rate != 0 || clock_Hz / rate > largest_prescaler) continue;
    for (std::uint32_t segment2 = 1; segment2 <= 8; ++segment2) {
      const std::uint32_t segment1 = quanta - 1 - segment2;
      if (segment1 < 1 || segment1 > 16) continue;
      const std::uint32_t miss = internal::sample_point_miss(quanta, segment2);
      if (5 * miss > quanta) continue;
      // Only a smaller miss / quanta is better; the fractions are compared without a division.
      if (best && miss * best->quanta() >= best_miss * quanta) continue;
      best = BitTiming{static_cast<std::uint32_t>(clock_Hz / rate), segment1, segment2};
      best_miss = miss;
    }
  }
  return best;
}

}  // namespace breakaway::hal
