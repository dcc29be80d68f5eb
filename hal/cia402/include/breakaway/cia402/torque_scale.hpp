// TorqueScale: turns force at the axis into the drive's torque, in per mille of its rated torque, and back.
//
// A force never exceeds the axis' limit or the drive's, for any input bits: the limit is cut down to whole per mille,
// and a force inside it is rounded to the nearest.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace breakaway::cia402 {

template <class Scalar>
class TorqueScale {
 public:
  // Without a rating every force is zero.
  TorqueScale() noexcept = default;

  // rated_torque_mNm is what 6076h shows, above 0; max_torque_per_mille is what 6072h shows. force_per_torque_N_per_Nm
  // and max_force_N must be finite and above 0.
  TorqueScale(std::uint32_t rated_torque_mNm, std::uint16_t max_torque_per_mille, Scalar force_per_torque_N_per_Nm,
              Scalar max_force_N) noexcept
      : quantum_N_{force_per_torque_N_per_Nm * static_cast<Scalar>(rated_torque_mNm) / Scalar{1'000'000}} {
    if (!std::isnormal(quantum_N_)) return;
    // A limit that is a whole number of quanta must not lose one to the rounding of the quotient.
    const Scalar quanta = max_force_N / quantum_N_ * (Scalar{1} + 4 * std::numeric_limits<Scalar>::epsilon());
    const Scalar most = static_cast<Scalar>(std::min<std::uint16_t>(max_torque_per_mille, highest_per_mille));
    limit_ = static_cast<std::int16_t>(std::min(quanta, most));
    max_force_N_ = std::min(max_force_N, force_N(limit_));
  }

  // Returns the nearest per mille inside the limit, and the limit for what is beyond it, so that |force| never exceeds
  // max_force_N. NaN and infinities give 0.
  std::int16_t per_mille(Scalar force_N) const noexcept {
    if (limit_ == 0 || !std::isfinite(force_N)) return 0;
    const auto limit = static_cast<Scalar>(limit_);
    const Scalar quanta = std::clamp(force_N / quantum_N_, -limit, limit);
    return static_cast<std::int16_t>(std::round(quanta));
  }
  Scalar force_N(std::int16_t per_mille) const noexcept { return static_cast<Scalar>(per_mille) * quantum_N_; }

  // The force of one per mille.
  Scalar quantum_N() const noexcept { return quantum_N_; }
  // The largest force that can be commanded.
  Scalar max_force_N() const noexcept { return max_force_N_; }
  std::int16_t limit_per_mille() const noexcept { return limit_; }

 private:
  static constexpr std::uint16_t highest_per_mille = 32767;  // 6071h is an int16

  Scalar quantum_N_{};
  Scalar max_force_N_{};
  std::int16_t limit_ = 0;
};

}  // namespace breakaway::cia402
