#include "tune_candidates.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::study {
namespace {

using Shares = std::vector<double>;

// To digits that a person would write.
double written(double value) { return std::isfinite(value) ? rounded_down(value, 3) : value; }

// The speed beyond which no limit matters, or the one that the file has.
double greatest_speed_m_s(const TunedAxis& axis) {
  return std::min(axis.allowed_m_s(),
                  std::isfinite(axis.fastest_m_s()) ? rounded_up(axis.fastest_m_s(), 2) : config::unlimited);
}

void add_speeds(std::vector<Gains>& to, const TunedAxis& axis, Gains gains, const Shares& shares) {
  const double most_m_s = greatest_speed_m_s(axis);
  for (const double share : shares) {
    if (!std::isfinite(most_m_s)) continue;
    gains.max_approach_speed_m_s = share == 1 ? most_m_s : written(share * most_m_s);
    to.push_back(gains);
  }
}

void add_moves(std::vector<Gains>& to, const TunedAxis& axis, Gains gains, const Shares& speeds,
               const Shares& accelerations) {
  const double most_m_s = greatest_speed_m_s(axis);
  const bool given = axis.axis().move.has_value();
  const double hardest = given ? axis.axis().move->acceleration_m_s2 : axis.hardest_m_s2();
  if (!std::isfinite(most_m_s) || !(hardest > 0)) return;
  for (const double acceleration : accelerations) {
    for (const double speed : speeds) {
      const double speed_m_s = given && speed == 1 ? most_m_s : written(speed * most_m_s);
      const double taken_m_s2 = given && acceleration == 1 ? hardest : written(acceleration * hardest);
      gains.move =
          config::Move{axis.distance_m(), speed_m_s, taken_m_s2, given ? axis.axis().move->jerk_m_s3 : std::nullopt};
      to.push_back(gains);
    }
  }
}

std::vector<Gains> braked_gains(const TunedAxis& axis, const Gains& base, GainGrid grid) {
  const bool fine = grid == GainGrid::fine;
  std::vector<Gains> all;
  if (axis.axis().move) {
    add_moves(all, axis, base, fine ? Shares{1, 0.9, 0.8, 0.65, 0.5} : Shares{1, 0.7},
              fine ? Shares{1, 0.9, 0.75, 0.6} : Shares{1, 0.8});
    return all;
  }
  add_speeds(all, axis, base,
             fine ? Shares{1, 0.98, 0.96, 0.94, 0.92, 0.9, 0.87, 0.84, 0.8, 0.75, 0.7, 0.6, 0.5, 0.4, 0.3}
                  : Shares{1, 0.85, 0.7, 0.5});
  add_moves(all, axis, base, fine ? Shares{1, 0.8, 0.65} : Shares{1}, fine ? Shares{1, 0.85, 0.7} : Shares{1});
  return all;
}

// Dampings by their ratios to the critical one; k1 from the greatest damping that the delay of the loop bears.
std::vector<Gains> feedback_gains(const TunedAxis& axis, const Gains& base, GainGrid grid) {
  const bool fine = grid == GainGrid::fine;
  const double mass_kg = axis.axis().mass_kg;
  const double lag_s = axis.axis().drive ? axis.axis().drive->current_loop_time_constant_s : 0;
  // Of `design`: the damping times the delay, with at least one period in which the velocity is smoothed.
  constexpr double most_delayed = 0.2;
  const double delay_s = lag_s + (axis.axis().latency_periods + 1) * axis.scenario().node.period_s();
  std::vector<Gains> all;
  const auto add = [&](double stiffness_N_per_m, double approach, double kick) {
    Gains gains = base;
    const double critical = 2 * std::sqrt(stiffness_N_per_m * mass_kg);
    gains.stiffness_N_per_m = stiffness_N_per_m;
    gains.approach_damping_Ns_per_m = written(approach * critical);
    gains.kick_damping_Ns_per_m = written(kick * critical);
    all.push_back(gains);
  };
  for (const double kick : fine ? Shares{1.5, 1.1, 2, 3} : Shares{1.5, 1.1}) {
    const double omega = most_delayed / (2 * kick * delay_s);
    for (const double approach : fine ? Shares{0.8, 0.6, 0.95} : Shares{0.8}) {
      if (axis.ideal()) {
        add(base.stiffness_N_per_m, approach, kick);
        continue;
      }
      for (const double share : fine ? Shares{0.9, 0.6, 0.4, 0.2} : Shares{0.9, 0.5})
        add(written(mass_kg * share * share * omega * omega), approach, kick);
    }
  }
  return all;
}

}  // namespace

std::vector<Gains> fast_gains(const TunedAxis& axis, law::Coast coast, GainGrid grid) {
  Gains base = axis.gains();
  base.coast = coast;
  if (coast == law::Coast::brake) return braked_gains(axis, base, grid);
  std::vector<Gains> all;
  if (coast == law::Coast::work) {
    add_speeds(all, axis, base,
               grid == GainGrid::fine ? Shares{1, 0.85, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2} : Shares{1, 0.7, 0.5});
    return all;
  }
  return feedback_gains(axis, base, grid);
}

Gains with_force(const TunedAxis& axis, Gains gains, double share) {
  gains.max_force_N = written(share * config::max_force_N(axis.axis()));
  return gains;
}

}  // namespace breakaway::study
