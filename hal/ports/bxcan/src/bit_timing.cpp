#include "breakaway/bxcan/bit_timing.hpp"

namespace breakaway::bxcan {
namespace {

// How far the sample point lies from 7/8 of the bit, in eighths of a quantum for one quantum: compare as fractions.
constexpr std::uint32_t miss(std::uint32_t quanta, std::uint32_t segment2) noexcept {
  const std::uint32_t eighths = 8 * segment2;
  return eighths > quanta ? eighths - quanta : quanta - eighths;
}

}  // namespace

std::optional<BitTiming> bit_timing(std::uint32_t clock_Hz, std::uint32_t bit_rate) noexcept {
  if (bit_rate == 0) return {};
  std::optional<BitTiming> best;
  std::uint32_t best_miss = 0;
  for (std::uint32_t quanta = 25; quanta >= 8; --quanta) {
    const std::uint64_t rate = std::uint64_t{quanta} * bit_rate;
    if (rate > clock_Hz || clock_Hz % rate != 0 || clock_Hz / rate > 1024) continue;
    for (std::uint32_t segment2 = 1; segment2 <= 8; ++segment2) {
      const std::uint32_t segment1 = quanta - 1 - segment2;
      if (segment1 < 1 || segment1 > 16) continue;
      // miss / quanta < best_miss / best quanta, without a division.
      if (best && miss(quanta, segment2) * best->quanta() >= best_miss * quanta) continue;
      best = BitTiming{static_cast<std::uint32_t>(clock_Hz / rate), segment1, segment2};
      best_miss = miss(quanta, segment2);
    }
  }
  return best;
}

}  // namespace breakaway::bxcan
