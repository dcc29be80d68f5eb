// TurnsScale: turns the drive's position, a float of turns, into counts of the axis.
//
// A float has 24 bits, so its spacing grows with the distance from zero: between 2^k and 2^(k+1) turns it is 2^(k-23)
// turns. A position is taken only where that is no more than a count; the reading is then off by half a spacing beside
// half a count, and the sum of the two is what a file's reading error must hold. The product is taken in double, so
// that it adds nothing.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

namespace breakaway::odrive {

// The distance of neighbouring floats at this magnitude, in the same unit.
constexpr double float_spacing(double magnitude) noexcept {
  const auto value = static_cast<float>(magnitude < 0 ? -magnitude : magnitude);
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return static_cast<double>(std::bit_cast<float>(bits + 1)) - static_cast<double>(value);
}

class TurnsScale {
 public:
  static constexpr double most_counts = 2147483647.0;

  // counts_per_turn: finite and above 0.
  constexpr explicit TurnsScale(double counts_per_turn) noexcept : counts_per_turn_{counts_per_turn} {}

  // Returns the nearest count, and nothing where is_fine() is false.
  std::optional<std::int32_t> counts(float turns) const noexcept {
    if (!is_fine(turns)) return {};
    return static_cast<std::int32_t>(std::lround(static_cast<double>(turns) * counts_per_turn_));
  }

  // Whether a float at this position is at least as fine as a count, and 32 bits count it. False for NaN.
  constexpr bool is_fine(double turns) const noexcept {
    const double magnitude = turns < 0 ? -turns : turns;
    if (!(magnitude * counts_per_turn_ <= most_counts)) return false;
    return float_spacing(magnitude) * counts_per_turn_ <= 1;
  }

 private:
  double counts_per_turn_;
};

}  // namespace breakaway::odrive
