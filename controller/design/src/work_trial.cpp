#include "work_trial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace breakaway::design::detail {
namespace {

constexpr int steps_per_swing = 30;
constexpr int longest_swings = 60;

}  // namespace

// The friction of each side is an impulse that at most stops it.
WorkTrial::End WorkTrial::run(double force_N, int periods) const {
  const std::array<double, 2> mass_kg{motor_kg, load_kg};
  const std::array<Friction, 2> friction{motor_friction, load_friction};
  const double swing_s = 2 * std::numbers::pi / std::sqrt(stiffness_N_per_m * (1 / motor_kg + 1 / load_kg));
  const int steps = std::max(4, static_cast<int>(std::ceil(period_s * steps_per_swing / swing_s)));
  const double h = period_s / steps;
  std::array<double, 2> x{bent_m, 0}, v{0, 0};
  std::vector<double> seen{bent_m};  // of the motor, at the start of each period
  const auto step = [&](double push_N) {
    const double apart_m = x[0] - x[1], half_m = gap_m / 2;
    const double spring_N = stiffness_N_per_m * (apart_m > half_m    ? apart_m - half_m
                                                 : apart_m < -half_m ? apart_m + half_m
                                                                     : 0);
    const std::array<double, 2> on_N{push_N - spring_N, spring_N};
    for (std::size_t side = 0; side < 2; ++side) {
      const double free_m_s = v[side] + on_N[side] * h / mass_kg[side];
      const bool towards = v[side] > 0 || (v[side] == 0 && free_m_s > 0);
      const double most_m_s = (towards ? friction[side].towards_N : friction[side].back_N) * h / mass_kg[side];
      v[side] = free_m_s - std::clamp(free_m_s, -most_m_s, most_m_s);
      x[side] += h * v[side];
    }
  };
  for (int k = 0; k < periods; ++k) {
    if (metered && k > latency_periods) {
      const auto newest = static_cast<std::size_t>(k - latency_periods);
      const double way_m = seen[newest] - bent_m, last_m = seen[newest] - seen[newest - 1];
      if (way_m + last_m * late_periods > most_travel_m) break;
    }
    for (int i = 0; i < steps; ++i) step(force_N);
    seen.push_back(x[0]);
  }
  const auto most_steps = static_cast<long>(std::ceil(std::max(longest_swings * swing_s, 100 * period_s) / h));
  long coasted = 0;
  // At rest neither mass moves under the spring that is left.
  while (coasted < most_steps) {
    const auto before = v;
    step(0);
    ++coasted;
    if (v[0] == 0 && v[1] == 0 && before[0] == 0 && before[1] == 0) break;
  }
  return {x[0] - bent_m, x[1], x[0] - x[1], static_cast<double>(coasted) * h};
}

}  // namespace breakaway::design::detail
