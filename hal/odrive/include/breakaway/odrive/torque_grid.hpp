// TorqueGrid: turns force at the axis into torque at the motor, and back.
//
// The protocol's torque is a float. It is rounded to a grid all the same, of so many steps up to the motor's largest
// torque, so that the design of the law, its table and the drive speak of one and the same force.
//
// A force never exceeds the axis' limit or the drive's, for any input bits: the limit is cut down to whole steps, and a
// force inside it goes to the nearest.
#pragma once

#include <algorithm>
#include <cmath>

namespace breakaway::odrive {

inline constexpr int torque_steps = 16384;

template <class Scalar>
class TorqueGrid {
 public:
  // All finite and above 0.
  TorqueGrid(Scalar max_torque_Nm, Scalar force_per_torque_N_per_Nm, Scalar max_force_N) noexcept
      : step_Nm_{max_torque_Nm / torque_steps}, step_N_{step_Nm_ * force_per_torque_N_per_Nm} {
    if (!std::isnormal(step_Nm_) || !std::isnormal(step_N_)) return;
    limit_ = std::floor(std::min(max_force_N / step_N_, Scalar{torque_steps}));
    while (limit_ > 0 && limit_ * step_N_ > max_force_N) limit_ -= 1;
  }

  // NaN and infinities give 0.
  float torque_Nm(Scalar force_N) const noexcept {
    if (limit_ == 0 || !std::isfinite(force_N)) return 0;
    return static_cast<float>(std::round(std::clamp(force_N / step_N_, -limit_, limit_)) * step_Nm_);
  }
  Scalar force_N(Scalar torque_Nm) const noexcept { return torque_Nm / step_Nm_ * step_N_; }

  Scalar step_N() const noexcept { return step_N_; }
  // The largest force that can be commanded; 0: a step is more than the axis' limit.
  Scalar max_force_N() const noexcept { return limit_ * step_N_; }

 private:
  Scalar step_Nm_, step_N_;
  Scalar limit_{0};  // steps
};

}  // namespace breakaway::odrive
