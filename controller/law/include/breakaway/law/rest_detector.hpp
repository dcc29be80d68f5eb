// RestDetector certifies rest from encoder counts.
//
// While |drive force| <= u < f_lo, a moving axis decelerates by at least (f_lo - u)/m. Had it still been moving after a
// time W without a change of count, it would have travelled at least (f_lo - u) W^2 / (2 m). That is one count q for W
// = sqrt(2 q m / (f_lo - u)), so: no change of count for W proves that the axis rests now. With u >= f_lo nothing can
// be proved; an axis that shows no change for `patience` periods is then taken for stuck, because its average speed is
// below q / (patience T) and it would otherwise be left creeping for ever.
#pragma once

#include <cstdint>

namespace breakaway::law {

template <class Scalar>
class RestDetector {
 public:
  constexpr RestDetector() noexcept = default;
  constexpr RestDetector(Scalar mass_kg, Scalar friction_lower_N, Scalar resolution_m, Scalar period_s) noexcept
      : friction_lower_N_{friction_lower_N},
        half_count_m_{resolution_m / 2},
        required_{2 * resolution_m * mass_kg / (period_s * period_s)} {}

  // Forgets what was seen and ignores the next `blind_periods` samples, which show the axis before a pulse acted on it:
  // without the restart after every pulse, an axis that is about to move is taken for one that rests.
  constexpr void restart(std::uint8_t blind_periods) noexcept {
    blind_ = blind_periods;
    unchanged_ = 0;
    largest_force_N_ = 0;
    anchored_ = false;
  }

  // Takes the newest position and the magnitude of the force commanded in the period before it. Returns true when rest
  // is certified.
  constexpr bool update(Scalar position_m, Scalar force_N) noexcept {
    if (blind_ > 0) {
      --blind_;
      return false;
    }
    const Scalar moved = position_m - anchor_m_;
    if (!anchored_ || moved > half_count_m_ || moved < -half_count_m_) {
      anchor_m_ = position_m;
      anchored_ = true;
      unchanged_ = 0;
      largest_force_N_ = 0;
      return false;
    }
    if (force_N > largest_force_N_) largest_force_N_ = force_N;
    if (unchanged_ < patience) ++unchanged_;
    const Scalar periods = static_cast<Scalar>(unchanged_);
    return periods * periods * (friction_lower_N_ - largest_force_N_) >= required_ || unchanged_ >= patience;
  }

  static constexpr std::int16_t patience = 20;

 private:
  Scalar friction_lower_N_{};
  Scalar half_count_m_{};
  Scalar required_{};  // 2 q m / T^2
  Scalar anchor_m_{};
  Scalar largest_force_N_{};
  std::int16_t unchanged_ = 0;
  std::uint8_t blind_ = 0;
  bool anchored_ = false;
};

}  // namespace breakaway::law
