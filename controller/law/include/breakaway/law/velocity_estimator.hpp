// VelocityEstimator takes the velocity from quantised positions: the difference over one period, smoothed only as far
// as the encoder demands.
#pragma once

#include <cstdint>

namespace breakaway::law {

// v += weight (dx / period - v). One count of quantisation then makes a damping force of at most weight * k2 * q /
// period. The weight is 1, no smoothing and no added delay, where that already is a small share of the least friction.
template <class Scalar>
class VelocityEstimator {
 public:
  constexpr VelocityEstimator() noexcept = default;

  // damping_Ns_per_m is the largest k2 that multiplies the estimate, friction_N the least friction force.
  constexpr VelocityEstimator(Scalar period_s, Scalar resolution_m, Scalar damping_Ns_per_m, Scalar friction_N) noexcept
      : per_period_{1 / period_s} {
    constexpr Scalar tolerated_share = Scalar(0.05);
    const Scalar force_of_one_count = damping_Ns_per_m * resolution_m * per_period_;
    if (force_of_one_count > tolerated_share * friction_N) weight_ = tolerated_share * friction_N / force_of_one_count;
  }

  constexpr Scalar update(Scalar position_m) noexcept {
    const Scalar difference = (position_m - previous_m_) * per_period_;
    if (primed_)
      velocity_ += weight_ * ((missed_ > 0 ? difference / static_cast<Scalar>(missed_ + 1) : difference) - velocity_);
    previous_m_ = position_m;
    missed_ = 0;
    primed_ = true;
    return velocity_;
  }

  // A period went by without a sample: the next difference spans one period more.
  constexpr void skip() noexcept {
    if (missed_ < 1000) ++missed_;
  }

  // The target moved by shift_m: the position error jumps, the axis does not.
  constexpr void shift_origin(Scalar shift_m) noexcept { previous_m_ -= shift_m; }

  constexpr void reset() noexcept {
    primed_ = false;
    missed_ = 0;
    velocity_ = 0;
  }

  constexpr Scalar velocity_m_s() const noexcept { return velocity_; }
  constexpr Scalar weight() const noexcept { return weight_; }

 private:
  Scalar per_period_{};
  Scalar weight_ = 1;
  Scalar previous_m_{};
  Scalar velocity_{};
  std::int16_t missed_ = 0;
  bool primed_ = false;
};

}  // namespace breakaway::law
