// PositionFactor: what a unit of the drive's position (6064h) is worth in counts of its encoder, from the factor group
// of CiA 402-2:
//
//   position = counts / position encoder resolution (608Fh, counts a motor revolution)
//                     / gear ratio (6091h, motor revolutions a revolution of the shaft)
//                     x feed constant (6092h, units a revolution of the shaft)
//
// Each of the three is a quotient of its sub-indices 1 and 2. Drives lack what they do not use, or show 0 there. A
// resolution without a feed constant says nothing of units, nor does a feed constant without a resolution, so that
// then neither counts; a divisor that is missing is 1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "breakaway/canopen/object_address.hpp"
#include "breakaway/cia402/objects.hpp"

namespace breakaway::cia402 {

class PositionFactor {
 public:
  // Takes a value of the factor group; other objects are passed over.
  constexpr void note(canopen::ObjectAddress object, std::uint32_t value) noexcept {
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (object.index == indices[i] && (object.subindex == 1 || object.subindex == 2))
        values_[i][object.subindex - 1U] = value;
    }
  }

  // Units of position for one count of the encoder, above 0; 1 where the drive does not say.
  constexpr float units_per_count() const noexcept {
    const bool used = values_[resolution][0] != 0 && values_[feed][0] != 0;
    const float of_revolution = used ? quotient(feed) / quotient(resolution) : 1.0F;
    return values_[gear][0] != 0 ? of_revolution / quotient(gear) : of_revolution;
  }

  // A unit is a count, but for what rounds away within the encoder's whole range of some million counts.
  constexpr bool is_one_to_one() const noexcept {
    const float units = units_per_count();
    return units > 1 - tolerance && units < 1 + tolerance;
  }
  // Readings jump by more than a unit from count to count.
  constexpr bool is_finer_than_encoder() const noexcept { return units_per_count() >= 1 + tolerance; }

 private:
  enum Quotient : std::size_t { resolution, gear, feed };
  static constexpr std::array<std::uint16_t, 3> indices{object::encoder_resolution, object::gear_ratio,
                                                        object::feed_constant};
  static constexpr float tolerance = 1e-6F;

  constexpr float quotient(Quotient which) const noexcept {
    const auto& [numerator, divisor] = values_[which];
    return static_cast<float>(numerator) / static_cast<float>(divisor != 0 ? divisor : 1U);
  }

  std::array<std::array<std::uint32_t, 2>, 3> values_{};  // 0: the drive did not say
};

}  // namespace breakaway::cia402
