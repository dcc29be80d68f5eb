#include "breakaway/design/spring_load.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "breakaway/design/braked_kicks.hpp"
#include "kick_table_builder.hpp"

namespace breakaway::design {

using std::numbers::pi;

namespace {

// A swing that is sampled once or twice may show the same count by chance, but not so often.
constexpr double unlikely_periods = 8;
constexpr double least_swings_per_period = 1.2;
constexpr double lags_of_a_pulse = 3;  // by which a current loop draws it out

// The class with its worst masses and forces.
struct Sprung {
  Sprung(const BrakedClass& axes, double commanded_brake_N)
      : load{*axes.spring_load},
        m1{load.motor_kg * heavier(axes)},
        m2{load.load_kg * heavier(axes)},
        K{load.stiffness_N_per_m},
        b{axes.force_gain.least * commanded_brake_N},
        most_b{axes.force_gain.most * commanded_brake_N},
        A1{std::max(load.motor_friction.lower_N - axes.load_N, 0.0)},
        A2{load.load_friction.lower_N},
        H{std::min(load.load_friction.upper_N, load.motor_friction.upper_N + axes.load_N + most_b)} {}

  static double heavier(const BrakedClass& axes) {
    return 2 * axes.mass_kg.most / (axes.mass_kg.least + axes.mass_kg.most);
  }
  double against_N() const { return load.encoder_on_load ? A1 + most_b : A2; }

  const SpringLoad& load;
  double m1, m2, K, b, most_b, A1, A2, H;
};

}  // namespace

double SpringLoad::resonance_Hz() const {
  return std::sqrt(stiffness_N_per_m * (1 / motor_kg + 1 / load_kg)) / (2 * pi);
}

double SpringLoad::critical_damping_Ns_per_m() const {
  return 2 * std::sqrt(stiffness_N_per_m * motor_kg * load_kg / (motor_kg + load_kg));
}

// A spring that both hold is bent by no more than the weaker of them holds.
double SpringLoad::unseen_m(double load_N) const {
  return std::min(motor_friction.upper_N + load_N, load_friction.upper_N) / stiffness_N_per_m;
}

// While the load seems to stand, its friction B2 balances the spring: that bends by 2 B2 / K at most, and the motor
// goes no further, though it may come from the other end. While the motor seems to stand, the load swings by at most
// what the drive's force bends. The force acts for the time of that: with the turn of the swing, and a start to the
// wrong side, a rigid axis would have gone four times as far; and further, as told, where the axis is heavier than told
// or its drive weaker.
double lost_motion_m(const BrakedClass& axes) {
  if (!axes.spring_load) return 0;
  const SpringLoad& load = *axes.spring_load;
  const double bent_m =
      (load.encoder_on_load ? 2 * load.load_friction.upper_N : axes.force_gain.most * axes.max_force_N) /
      load.stiffness_N_per_m;
  return 4 * (bent_m + load.gap_m) * Sprung::heavier(axes) / axes.force_gain.least;
}

double sprung_m(const BrakedClass& axes, double brake_N, double force_N, int periods) {
  if (!axes.spring_load) return 0;
  const Sprung s{axes, brake_N};
  const double M = s.m1 + s.m2, rho = s.m2 / s.m1, Mw2 = s.K * M * M / (s.m1 * s.m2), g = s.A1 + s.A2 + s.b;
  const double F = axes.force_gain.most * force_N + axes.load_N, net_N = std::max(F - s.A1, s.A2);
  const double pulse_s = periods * axes.period_s + axes.jitter_s + lags_of_a_pulse * axes.lag_s.most;
  const double late_s = std::sqrt(2 * (s.A2 + s.H) * s.m1 / (net_N * s.K));
  const double motor_m = 2 * (rho * net_N + (1 + rho) * s.H) / Mw2 + s.A2 * pulse_s * late_s / M;
  const double held_N = s.H + s.against_N();
  return (F + s.b) * motor_m / g + held_N * held_N / (2 * s.K * g);
}

double sprung_rest_s(const BrakedClass& axes, double brake_N) {
  if (!axes.spring_load) return 0;
  const Sprung s{axes, brake_N};
  const bool on_load = s.load.encoder_on_load;
  const double hidden_kg = on_load ? s.m1 : s.m2, hidden_N = on_load ? s.A1 : s.A2;
  const double driven_N = (on_load ? s.load.load_friction.upper_N : s.load.motor_friction.upper_N) + s.most_b;
  const double swings = hidden_N > 0 ? 1 + std::ceil(std::max(driven_N / hidden_N - 1, 0.0) / 2)
                                     : std::numeric_limits<double>::infinity();
  return pi * std::sqrt(hidden_kg / s.K) * swings + unlikely_periods * axes.period_s;
}

template <class Real>
SpringDemand spring_demand(const BrakedClass& axes, const BrakedDesign<Real>& design) {
  const double brake_N = static_cast<double>(design.kicks.brake_N);
  const Sprung s{axes, brake_N};
  const law::KickTable<Real>& table = design.kicks.table;
  SpringDemand demand{.swing_s = pi / 2 * std::sqrt(s.m1 / s.K), .least_per_period = least_swings_per_period};
  demand.nearest_m = sprung_m(axes, brake_N, axes.max_force_N, 1);
  demand.beyond_m = demand.nearest_m;
  for (std::size_t i = 0; i < table.count; ++i) {
    const double force_N = std::min(detail::greatest_force_N(table, i), axes.max_force_N);
    demand.beyond_m = std::max(demand.beyond_m, sprung_m(axes, brake_N, force_N, table.periods[i]));
  }
  return demand;
}

// A time falls with the resonance as 1/f, and a way at least so.
double SpringDemand::safe_from_Hz(const BrakedClass& axes, double tolerance_m) const {
  const double shortest_s = axes.period_s - axes.jitter_s;
  return std::max(least_per_period / shortest_s,
                  axes.spring_load->resonance_Hz() * std::max(nearest_m / tolerance_m, swing_s / shortest_s));
}

template SpringDemand spring_demand(const BrakedClass&, const BrakedDesign<float>&);
template SpringDemand spring_demand(const BrakedClass&, const BrakedDesign<double>&);

}  // namespace breakaway::design
