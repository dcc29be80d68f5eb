// A mass under dry friction that is constant, and a force that is constant for a while: followed exactly.
#pragma once

#include <algorithm>
#include <array>
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

  // A force that tends to `to_N` as a current loop with this time constant does, in slices of its mean. That each force
  // began a time constant later, which owes as much, is too kind to a pulse that hardly exceeds friction: until the
  // loop is there it does not move the axis at all. Returns the force at the end.
  double push_behind_lag(double from_N, double to_N, double lag_s, double time_s) noexcept {
    if (!(lag_s > 0)) {
      push(to_N, time_s);
      return to_N;
    }
    constexpr std::array<double, 13> ends{0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1, 1.3, 1.7, 2.3, 3, 4.5, 1e9};
    double began_s = 0, owed = 1;  // the share of the change that is still to come
    for (const double end : ends) {
      const double ends_s = std::min(end * lag_s, time_s);
      const double left = std::exp(-ends_s / lag_s), slice_s = ends_s - began_s;
      push(to_N + (from_N - to_N) * (owed - left) * lag_s / slice_s, slice_s);
      if (ends_s == time_s) break;
      began_s = ends_s;
      owed = left;
    }
    return to_N + (from_N - to_N) * std::exp(-time_s / lag_s);
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
