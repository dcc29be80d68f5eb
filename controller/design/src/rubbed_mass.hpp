// A mass under dry friction that is constant, and a force that is constant for a while: followed exactly.
#pragma once

#include <algorithm>
#include <cmath>

namespace breakaway::design::detail {

class RubbedMass {
 public:
  RubbedMass(double mass_kg, double friction_N, double position_m) noexcept
      : mass_kg_{mass_kg}, friction_N_{friction_N}, x_{position_m}, furthest_m_{position_m} {}

  void push(double force_N, double left_s) noexcept {
    while (left_s > 0) {
      if (v_ == 0 && std::abs(force_N) <= friction_N_) return;
      const double direction = v_ == 0 ? force_N : v_;
      const double acceleration = (force_N - std::copysign(friction_N_, direction)) / mass_kg_;
      const double stops_s = acceleration * direction < 0 ? -v_ / acceleration : left_s;
      const double time_s = std::min(left_s, stops_s);
      x_ += (v_ + acceleration * time_s / 2) * time_s;
      v_ = time_s == stops_s && stops_s < left_s ? 0 : v_ + acceleration * time_s;
      furthest_m_ = std::max(furthest_m_, x_);
      fastest_m_s_ = std::max(fastest_m_s_, std::abs(v_));
      left_s -= time_s;
    }
  }

  double position_m() const noexcept { return x_; }
  double velocity_m_s() const noexcept { return v_; }
  double furthest_m() const noexcept { return furthest_m_; }
  double fastest_m_s() const noexcept { return fastest_m_s_; }

 private:
  double mass_kg_, friction_N_, x_, v_ = 0;
  double furthest_m_, fastest_m_s_ = 0;
};

}  // namespace breakaway::design::detail
