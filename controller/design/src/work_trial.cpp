#include "work_trial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace breakaway::design::detail {
namespace {

constexpr int steps_per_swing = 30;
constexpr int longest_swings = 60;

// Steps of h under a force, and an impulse of friction that at most stops it.
class Side {
 public:
  Side(double at_m, double h, double mass_kg, const WorkTrial::Friction& friction)
      : x_m{at_m},
        h_{h},
        gain_{h / mass_kg},
        towards_m_s_{friction.towards_N * gain_},
        back_m_s_{friction.back_N * gain_} {}

  void step(double force_N) {
    const double free_m_s = v_m_s_ + force_N * gain_;
    const bool towards = v_m_s_ > 0 || (v_m_s_ == 0 && free_m_s > 0);
    const double most_m_s = towards ? towards_m_s_ : back_m_s_;
    v_m_s_ = free_m_s - std::clamp(free_m_s, -most_m_s, most_m_s);
    x_m += h_ * v_m_s_;
  }
  bool rests() const { return v_m_s_ == 0; }

  double x_m;

 private:
  double v_m_s_ = 0;
  double h_, gain_;  // gain_: of the speed, by a newton
  double towards_m_s_, back_m_s_;
};

}  // namespace

WorkTrial::End WorkTrial::run(double force_N, int periods) const {
  const double swing_s = 2 * std::numbers::pi / std::sqrt(stiffness_N_per_m * (1 / motor_kg + 1 / load_kg));
  const int steps = std::max(4, static_cast<int>(std::ceil(period_s * steps_per_swing / swing_s)));
  const double h = period_s / steps;
  Side motor{bent_m, h, motor_kg, motor_friction}, load{0, h, load_kg, load_friction};
  std::vector<double> seen{bent_m};  // of the motor, at the start of each period
  const double half_m = gap_m / 2;
  const auto step = [&](double push_N) {
    const double apart_m = motor.x_m - load.x_m;
    const double spring_N = stiffness_N_per_m * (apart_m - std::clamp(apart_m, -half_m, half_m));
    motor.step(push_N - spring_N);
    load.step(spring_N);
  };
  for (int k = 0; k < periods; ++k) {
    if (metered && k > latency_periods) {
      const auto newest = static_cast<std::size_t>(k - latency_periods);
      const double way_m = seen[newest] - bent_m, last_m = seen[newest] - seen[newest - 1];
      if (way_m + last_m * late_periods > most_travel_m) break;
    }
    for (int i = 0; i < steps; ++i) step(force_N);
    seen.push_back(motor.x_m);
  }
  const auto most_steps = static_cast<long>(std::ceil(std::max(longest_swings * swing_s, 100 * period_s) / h));
  long coasted = 0;
  // At rest neither mass moves under the spring that is left.
  while (coasted < most_steps) {
    const bool rested = motor.rests() && load.rests();
    step(0);
    ++coasted;
    if (rested && motor.rests() && load.rests()) break;
  }
  return {motor.x_m - bent_m, load.x_m, motor.x_m - load.x_m, static_cast<double>(coasted) * h};
}

}  // namespace breakaway::design::detail
