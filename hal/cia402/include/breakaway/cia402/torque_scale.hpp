// TorqueScale: turns force at the axis into the drive's torque, in per mille of its rated torque, and back.
//
// Most drives count the target torque (6071h) in per mille of the rated torque (6076h), some in per mille of the
// largest torque (6072h); the actual torque (6077h), and 6072h itself, count in per mille of the rated one in either.
//
// A force never exceeds the axis' limit or the drive's, for any input bits: the limit is cut down to whole per mille,
// and a force inside it is rounded to the nearest.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace breakaway::cia402 {

// What a target torque of 1000 is.
enum class TorqueBase : std::uint8_t {
  rated,    // the rated torque, 6076h
  largest,  // the largest one, 6072h
};

template <class Scalar>
class TorqueScale {
 public:
  static constexpr std::uint16_t highest_per_mille = 32767;  // 6071h is an int16

  // Without a rating every force is zero.
  TorqueScale() noexcept = default;

  // rated_torque_mNm is what 6076h shows, above 0; max_torque_per_mille is what 6072h shows. force_per_torque_N_per_Nm
  // and max_force_N must be finite and above 0.
  TorqueScale(std::uint32_t rated_torque_mNm, std::uint16_t max_torque_per_mille, Scalar force_per_torque_N_per_Nm,
              Scalar max_force_N, TorqueBase base = TorqueBase::rated) noexcept
      : quantum_N_{force_per_torque_N_per_Nm * static_cast<Scalar>(rated_torque_mNm) / Scalar{1'000'000}},
        target_quantum_N_{quantum_N_} {
    const Scalar largest = static_cast<Scalar>(std::min<std::uint16_t>(max_torque_per_mille, highest_per_mille));
    if (base == TorqueBase::largest) target_quantum_N_ *= largest / Scalar{1000};
    if (!std::isnormal(target_quantum_N_)) return;
    const Scalar most = base == TorqueBase::largest ? Scalar{1000} : largest;
    // A limit that is a whole number of quanta must not lose one to the rounding of the quotient.
    const Scalar quanta = max_force_N / target_quantum_N_ * (Scalar{1} + 4 * std::numeric_limits<Scalar>::epsilon());
    limit_ = static_cast<std::int16_t>(std::min(quanta, most));
    max_force_N_ = std::min(max_force_N, static_cast<Scalar>(limit_) * target_quantum_N_);
  }

  // Returns the target torque for a force: the nearest per mille inside the limit, and the limit for what is beyond it,
  // so that |force| never exceeds max_force_N. NaN and infinities give 0.
  std::int16_t per_mille(Scalar force_N) const noexcept {
    if (limit_ == 0 || !std::isfinite(force_N)) return 0;
    const auto limit = static_cast<Scalar>(limit_);
    const Scalar quanta = std::clamp(force_N / target_quantum_N_, -limit, limit);
    return static_cast<std::int16_t>(std::round(quanta));
  }
  // Returns the force of an actual torque.
  Scalar force_N(std::int16_t per_mille) const noexcept { return static_cast<Scalar>(per_mille) * quantum_N_; }

  // The force of one per mille of the rated torque.
  Scalar quantum_N() const noexcept { return quantum_N_; }
  // The largest force that can be commanded.
  Scalar max_force_N() const noexcept { return max_force_N_; }
  // The same as a target torque.
  std::int16_t limit_per_mille() const noexcept { return limit_; }

 private:
  Scalar quantum_N_{};
  Scalar target_quantum_N_{};  // of one per mille of what a target torque counts in
  Scalar max_force_N_{};
  std::int16_t limit_ = 0;
};

}  // namespace breakaway::cia402
