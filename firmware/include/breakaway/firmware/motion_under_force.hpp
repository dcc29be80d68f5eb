// MotionUnderForce: tells when an axis would have to move and its encoder shows nothing, because it is broken, because
// the axis stands against something, or because its friction is larger than was told.
//
// Under a force F beyond the largest friction a mass gains speed by (|F| - f_upper) / m at least. From rest it has gone
// x = (|F| - f_upper) t^2 / (2 m) after t. An axis that was still on its way back when its count changed last, with
// less than the speed that one count brakes, is behind that by 9 of 20 counts at most; so an axis that has shown no
// count for the time of 20 does not move as it must. The time is counted while the force lasts without a break, and it
// must last 10 ms and five samples at least: so long a spring or a gap between motor and encoder may take.
#pragma once

#include <cmath>

namespace breakaway::firmware {

template <class Scalar>
class MotionUnderForce {
 public:
  static constexpr int least_samples = 5;
  static constexpr Scalar least_time_s = Scalar(0.01);
  static constexpr Scalar counts = 20;

  // friction_upper_N: infinite where it is not known, and nothing is watched.
  constexpr MotionUnderForce(Scalar mass_kg, Scalar friction_upper_N, Scalar resolution_m) noexcept
      : mass_kg_{mass_kg}, friction_upper_N_{friction_upper_N}, resolution_m_{resolution_m} {}

  void restart() noexcept { samples_ = 0, time_s_ = speed_m_s_ = expected_m_ = Scalar{0}; }

  // Takes a fresh sample: the travel and the time since the sample before, and the force that the drive gives.
  void sample(Scalar travel_m, Scalar force_N, Scalar elapsed_s) noexcept {
    const Scalar excess_N = std::abs(force_N) - friction_upper_N_;
    const bool turned = (force_N > 0) != pushes_up_;
    pushes_up_ = force_N > 0;
    if (travel_m != 0 || turned || !(excess_N > 0)) return restart();
    time_s_ += elapsed_s;
    speed_m_s_ += excess_N / mass_kg_ * elapsed_s;
    expected_m_ += speed_m_s_ * elapsed_s;
    if (samples_ < least_samples) ++samples_;
  }

  // The sum of ten periods of a millisecond may round to less than 10 ms.
  bool missing() const noexcept {
    return samples_ == least_samples && time_s_ > Scalar(0.99) * least_time_s && expected_m_ > counts * resolution_m_;
  }

 private:
  Scalar mass_kg_, friction_upper_N_, resolution_m_;
  Scalar time_s_{}, speed_m_s_{}, expected_m_{};
  bool pushes_up_ = false;
  int samples_ = 0;
};

}  // namespace breakaway::firmware
