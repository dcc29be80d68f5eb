// MotionUnderForce: tells when an axis would have to move and its encoder shows nothing, because it is broken, because
// the axis stands against something, or because its friction is larger than was told.
//
// Under a force F above the one that breaks it away for certain, f, a mass gains speed by (|F| - f) / m at least. From
// rest it has gone x = (|F| - f) t^2 / (2 m) after t. An axis that was still on its way back when its count changed
// last, with less than the speed that one count brakes, is behind that by 9 of 20 counts at most. One whose mass and
// force gain are each off by a fifth goes two thirds as far, and is behind by less. So an axis that has shown no count
// for the time of 20 does not move as it must. A spring or a gap before the encoder takes up its lost motion besides.
// The time is counted while the force lasts without a break, and it must last 10 ms and five samples at least: so long
// springs may take of which nobody was told.
#pragma once

#include <cmath>

namespace breakaway::firmware {

template <class Scalar>
class MotionUnderForce {
 public:
  static constexpr int least_samples = 5;
  static constexpr Scalar least_time_s = Scalar(0.01);
  static constexpr Scalar counts = 20;

  // breakaway_N: infinite where it is not known, and nothing is watched.
  constexpr MotionUnderForce(Scalar mass_kg, Scalar breakaway_N, Scalar resolution_m, Scalar lost_motion_m = 0) noexcept
      : mass_kg_{mass_kg}, breakaway_N_{breakaway_N}, least_m_{counts * resolution_m + lost_motion_m} {}

  void restart() noexcept { samples_ = 0, time_s_ = speed_m_s_ = expected_m_ = Scalar{0}; }

  // Takes a fresh sample: the travel and the time since the sample before, and the force that the drive gives.
  void sample(Scalar travel_m, Scalar force_N, Scalar elapsed_s) noexcept {
    const Scalar excess_N = std::abs(force_N) - breakaway_N_;
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
    return samples_ == least_samples && time_s_ > Scalar(0.99) * least_time_s && expected_m_ > least_m_;
  }

 private:
  Scalar mass_kg_, breakaway_N_, least_m_;
  Scalar time_s_{}, speed_m_s_{}, expected_m_{};
  bool pushes_up_ = false;
  int samples_ = 0;
};

}  // namespace breakaway::firmware
