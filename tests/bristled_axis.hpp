// An axis whose friction bends before it slides (Dahl, LuGre), as Slider is one whose friction holds at once. The
// equations are those of model::Presliding; here they are followed by splitting a period into short slices, in each of
// which the bend relaxes in closed form, so that bristles of any stiffness need slices of their ringing only.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "kicked_axis.hpp"

namespace breakaway::testing {

struct Bristles {
  double stiffness_N_per_m = 1e6;
  double damping_Ns_per_m = 0;  // 0: Dahl's law
  double resting_m_s = 1e-5;    // an axis slower than this counts as one that is about to slip
};

class BristledSlider {
 public:
  BristledSlider(const TrueAxis& axis, const Bristles& bristles, Friction friction, double position_m,
                 double velocity_m_s)
      : axis_{axis}, bristles_{bristles}, friction_{std::move(friction)}, x_{position_m}, v_{velocity_m_s} {}

  double position_m() const { return x_; }
  double velocity_m_s() const { return v_; }
  // As the drive tells it.
  double given_N() const { return u_ / axis_.force_gain; }
  // It never rests quite, so that what is asked is whether it still rings by a count.
  bool moves(double resolution_m) const {
    return std::fabs(v_) > resolution_m * std::sqrt(bristles_.stiffness_N_per_m / axis_.mass_kg);
  }

  void run(double command_N, double period_s, int /*slices*/) {
    const double omega = std::sqrt(bristles_.stiffness_N_per_m / axis_.mass_kg);
    const int slices = std::clamp(static_cast<int>(std::ceil(period_s * omega / 0.1)), 20, 40000);
    for (int i = 0; i < slices; ++i) slice(axis_.force_gain * command_N, period_s / slices);
  }

 private:
  void slice(double U, double h) {
    const double left = axis_.lag_s > 0 ? std::exp(-h / axis_.lag_s) : 0;
    const double mean_N = axis_.lag_s > 0 ? U + (u_ - U) * (1 - left) * axis_.lag_s / h : U;
    u_ = U + (u_ - U) * left;
    const double force_N = mean_N + axis_.load_N, s0 = bristles_.stiffness_N_per_m;
    const double before_m_s = v_;
    const double level_N = friction_({t_, x_, v_, force_N, std::fabs(v_) < bristles_.resting_m_s});
    bend(level_N, h / 2);
    const double along = v_ != 0 ? v_ : force_N;
    const double following = std::max(0.0, 1 - (along > 0 ? 1 : -1) * s0 * z_ / level_N);
    const double damping = bristles_.damping_Ns_per_m * following;
    const double net_N = force_N - s0 * z_;
    const double decay = damping * h / axis_.mass_kg;
    v_ = decay > 1e-9 ? v_ * std::exp(-decay) - net_N / damping * std::expm1(-decay) : v_ + net_N * h / axis_.mass_kg;
    bend(level_N, h / 2);
    x_ += h * (before_m_s + v_) / 2;
    t_ += h;
  }
  // z' = v - s0 |v| z / g, for this speed.
  void bend(double level_N, double h) {
    const double s0 = bristles_.stiffness_N_per_m, end_m = (v_ > 0 ? level_N : -level_N) / s0;
    const double share = -std::expm1(-s0 * std::fabs(v_) * h / level_N);
    z_ += (end_m - z_) * share;
  }

  TrueAxis axis_;
  Bristles bristles_;
  Friction friction_;
  double x_, v_, z_ = 0, u_ = 0, t_ = 0;
};

}  // namespace breakaway::testing
