// TravelGuard: says when an axis of unknown mass and friction must brake, so that it stops before the end of its
// travel.
//
// Friction only takes energy, so the axis never has more than the work that the commanded forces have done on it; and
// a force against the motion takes that much again within work / force, friction or not. What force acted during a step
// is not known to the period, because latency and lag are not: the guard counts the one of the last `reach` commands
// that did most, and adds what the axis moves within `reach` periods at its speed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace breakaway::identify {

template <class Scalar>
class TravelGuard {
 public:
  // reach: periods within which a command surely acts, latency and lag together.
  constexpr TravelGuard(Scalar lowest_m, Scalar highest_m, Scalar margin_m, Scalar reach_s, std::size_t reach) noexcept
      : lowest_m_{lowest_m + margin_m}, highest_m_{highest_m - margin_m}, reach_s_{reach_s}, reach_{reach} {}

  static constexpr std::size_t most_reach = 64;

  // The axis rests: it has no energy.
  void restart() noexcept { work_J_ = 0; }
  void moved(Scalar step_m) noexcept {
    if (step_m == 0) return;
    Scalar most_N = commands_[0];
    for (std::size_t i = 1; i < reach_; ++i)
      most_N = step_m > 0 ? std::max(most_N, commands_[i]) : std::min(most_N, commands_[i]);
    work_J_ = std::max(work_J_ + most_N * step_m, Scalar{0});
  }
  void command(Scalar force_N) noexcept {
    next_ = next_ + 1 < reach_ ? next_ + 1 : 0;
    commands_[next_] = force_N;
  }
  void shift_origin(Scalar shift_m) noexcept { lowest_m_ -= shift_m, highest_m_ -= shift_m; }

  // With brake_N against the motion from now on, the axis might not stop within its travel if it went on any longer.
  bool must_brake(Scalar position_m, Scalar speed_m_s, Scalar acceleration_m_s2, Scalar brake_N) const noexcept {
    if (speed_m_s == 0) return false;
    const Scalar direction = speed_m_s > 0 ? Scalar{1} : Scalar{-1};
    const Scalar gained_m_s = std::max(direction * acceleration_m_s2, Scalar{0}) * reach_s_;
    const Scalar needed_m = work_J_ / brake_N + 3 * (std::abs(speed_m_s) + gained_m_s) * reach_s_;
    return needed_m > room_m(position_m, direction);
  }
  Scalar room_m(Scalar position_m, Scalar direction) const noexcept {
    return direction > 0 ? highest_m_ - position_m : position_m - lowest_m_;
  }

 private:
  Scalar lowest_m_, highest_m_, reach_s_;
  std::size_t reach_, next_ = 0;
  std::array<Scalar, most_reach> commands_{};
  Scalar work_J_ = 0;
};

}  // namespace breakaway::identify
