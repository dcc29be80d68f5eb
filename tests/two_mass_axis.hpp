// A motor and a load on a spring, each on friction of its own, for run_axis() of kicked_axis.hpp: stepped so finely
// that a swing of the two takes two hundred steps, with the friction of each side as an impulse that at most stops it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "breakaway/design/spring_load.hpp"
#include "kicked_axis.hpp"

namespace breakaway::testing {

class TwoMassAxis {
 public:
  // whole: of both, but for the mass; the spring is damped by this share of its critical damping. friction: of the
  // motor and of the load. out_of_sight_m: is told where the side without the encoder is.
  TwoMassAxis(const design::SpringLoad& load, double damping, const TrueAxis& whole, std::array<Friction, 2> friction,
              double position_m, double* out_of_sight_m = nullptr)
      : load_{load},
        whole_{whole},
        friction_{std::move(friction)},
        mass_kg_{load.motor_kg, load.load_kg},
        out_of_sight_m_{out_of_sight_m} {
    x_.fill(position_m);
    const double w = 2 * pi * load.resonance_Hz(), reduced_kg = load.stiffness_N_per_m / (w * w);
    damping_Ns_per_m_ = 2 * damping * w * reduced_kg;
    longest_step_s_ = 2 * pi / w / 200;
  }

  double position_m() const { return x_[seen()]; }
  double velocity_m_s() const { return v_[seen()]; }
  // As the drive tells it.
  double given_N() const { return u_ / whole_.force_gain; }
  // By a count in a swing.
  bool moves(double resolution_m) const {
    return std::max(std::fabs(v_[0]), std::fabs(v_[1])) * longest_step_s_ * 200 > resolution_m;
  }

  void run(double command_N, double period_s, int /*slices*/) {
    const double U = whole_.force_gain * command_N;
    const int steps = std::max(8, static_cast<int>(std::ceil(period_s / longest_step_s_)));
    const double h = period_s / steps;
    const double half_left = whole_.lag_s > 0 ? std::exp(-h / 2 / whole_.lag_s) : 0;
    for (int i = 0; i < steps; ++i) {
      step(U + (u_ - U) * half_left + whole_.load_N, h);
      u_ = U + (u_ - U) * half_left * half_left;
    }
    if (out_of_sight_m_ != nullptr) *out_of_sight_m_ = x_[1 - seen()];
  }

 private:
  static constexpr double pi = 3.14159265358979323846;

  std::size_t seen() const { return load_.encoder_on_load ? 1 : 0; }

  // The spring is loose within the gap, and its damper does not pull them together.
  double joint_N() const {
    const double apart_m = x_[0] - x_[1], half_m = load_.gap_m / 2;
    const double bent_m = apart_m > half_m ? apart_m - half_m : apart_m < -half_m ? apart_m + half_m : 0;
    if (bent_m == 0 && load_.gap_m > 0) return 0;
    const double force_N = load_.stiffness_N_per_m * bent_m + damping_Ns_per_m_ * (v_[0] - v_[1]);
    return load_.gap_m > 0 && force_N * bent_m < 0 ? 0 : force_N;
  }

  void step(double push_N, double h) {
    const double spring_N = joint_N();
    const std::array<double, 2> force_N{push_N - spring_N, spring_N};
    for (std::size_t side = 0; side < 2; ++side) {
      const double most_m_s =
          friction_[side]({t_, x_[side], v_[side], force_N[side], v_[side] == 0}) * h / mass_kg_[side];
      const double free_m_s = v_[side] + force_N[side] * h / mass_kg_[side];
      v_[side] = free_m_s - std::clamp(free_m_s, -most_m_s, most_m_s);
    }
    for (std::size_t side = 0; side < 2; ++side) x_[side] += h * v_[side];
    t_ += h;
  }

  design::SpringLoad load_;
  TrueAxis whole_;
  std::array<Friction, 2> friction_;
  std::array<double, 2> mass_kg_, x_{}, v_{};
  double* out_of_sight_m_;
  double damping_Ns_per_m_ = 0, longest_step_s_ = 0, u_ = 0, t_ = 0;
};

}  // namespace breakaway::testing
