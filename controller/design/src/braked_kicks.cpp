#include "breakaway/design/braked_kicks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "kick_class.hpp"
#include "kick_table_builder.hpp"
#include "worst_kicks.hpp"

namespace breakaway::design {
namespace {

using detail::KickClass;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double longest_count = 30000;  // of periods
constexpr int most_counted = 100000;     // kicks

std::uint16_t counted(double periods) {
  return static_cast<std::uint16_t>(std::clamp(std::ceil(periods), 1.0, longest_count));
}

// Without a count of motion for so many periods an axis that loses speed under this net force is at rest.
double still_periods(const BrakedClass& axes, double net_force_N) {
  if (!(net_force_N > 0)) return infinity;
  return std::sqrt(2 * axes.encoder_resolution_m * axes.mass_kg.most / net_force_N) / axes.period_s;
}

double spread(const Interval& interval) { return (interval.most - interval.least) / (interval.most + interval.least); }

template <class Real>
law::BrakedApproach<Real> approach(const BrakedClass& axes, const KickClass& kicks) {
  const double T = axes.period_s, q = axes.encoder_resolution_m, m = axes.mass_kg.most;
  const double stop_N = kicks.least_friction_N() + axes.force_gain.least * kicks.brake_N();
  const double gap_N = kicks.most_friction_N() - kicks.least_friction_N();
  const double gentle = stop_N / m, lag_s = (axes.lag_s.least + axes.lag_s.most) / 2;
  const double response_s = T + 2 * lag_s;
  // A share g of a reading's surprise lets the estimated speed err by g q / T for the count and by doubt T / (m g) for
  // what is not known of the force: the sum is least at the g below. More of it than force for it would be no use.
  const double doubt_N = gap_N + (0.02 + spread(axes.mass_kg) + spread(axes.force_gain)) * stop_N;
  const double most_correction = 0.5 * (kicks.limit_N() - kicks.most_friction_N()) * T * response_s / (m * q);
  const double correction = std::clamp(std::min(T * std::sqrt(doubt_N / (m * q)), most_correction), 1e-3, 1.0);
  const double speed_error = correction * q / T + doubt_N * T / (m * correction);
  // Below the last of these speeds the axis might stick where the plan asks for no more force than friction takes.
  const double speed = std::max({5 * speed_error, 2 * gap_N * (response_s + axes.latency_periods * T) / m,
                                 gentle * (T * (1 + 0.4 * axes.latency_periods) + axes.lag_s.most)});
  return {
      .mass_kg = static_cast<Real>((axes.mass_kg.least + axes.mass_kg.most) / 2),
      .friction_N = static_cast<Real>(kicks.least_friction_N()),
      .hard_m_s2 = static_cast<Real>(0.8 * (axes.force_gain.least * kicks.limit_N() + kicks.least_friction_N()) / m),
      .gentle_m_s2 = static_cast<Real>(gentle),
      .switch_speed_m_s = static_cast<Real>(speed),
      .switch_distance_m = static_cast<Real>(speed * speed / (2 * gentle)),
      .short_of_target_m = static_cast<Real>(speed * gap_N * T / stop_N),
      .response_s = static_cast<Real>(response_s),
      .lag_s = static_cast<Real>(lag_s),
      .correction = static_cast<Real>(correction)};
}

// e^(-T/tau), rounded to the side asked for.
template <class Real>
Real share_left(double period_s, double lag_s, Real towards) {
  if (lag_s == 0) return 0;
  const auto nearest = static_cast<Real>(std::exp(-period_s / lag_s));
  return nearest > 0 ? std::nextafter(nearest, towards) : Real{0};
}

}  // namespace

double most_travel_m(const BrakedClass& axes, double force_N, int periods, int cut_periods) {
  return KickClass{axes}.most_travel_m(force_N, periods, cut_periods);
}
double least_travel_m(const BrakedClass& axes, double force_N, int periods, int cut_periods) {
  return KickClass{axes}.least_travel_m(force_N, periods, cut_periods);
}

namespace {

// The distance that the least sure pulse goes at most, and the force of the least sure one.
struct LeastPulse {
  double distance_m = infinity;
  double force_N = infinity;
};

LeastPulse least_pulse(const KickClass& kicks) {
  LeastPulse least;
  for (int n = 1; n <= longest_pulse_periods; ++n) {
    const double needed_N = kicks.needed_N(n);
    least.force_N = std::min(least.force_N, needed_N);
    if (needed_N <= kicks.limit_N() * (1 + 1e-9))
      least.distance_m = std::min(least.distance_m, kicks.most_travel_m(needed_N, n, kicks.cut_periods(needed_N, n)));
  }
  return least;
}

// In periods.
struct Waits {
  double still, either_way, settling;
};

// theta_N: the force under which a reading that stays proves rest after a kick; holding_N: either way.
Waits waits(const BrakedClass& axes, const KickClass& kicks, double theta_N, double holding_N) {
  const double gain = theta_N > 0 ? axes.force_gain.most : axes.force_gain.least, A = kicks.least_friction_N();
  return {still_periods(axes, A - gain * theta_N), still_periods(axes, A - axes.force_gain.most * holding_N),
          std::ceil(4 * axes.lag_s.most / axes.period_s)};
}

// All but the table.
template <class Real>
law::BrakedKicks<Real> numbers(const BrakedClass& axes, const KickClass& kicks, bool& rest_is_seen) {
  const double b = kicks.brake_N(), gains = axes.force_gain.most / axes.mass_kg.least * axes.mass_kg.most;
  const double theta_N = axes.lag_s.most > 0 ? 0.1 * kicks.held_N() : -b, holding_N = (b + kicks.held_N()) / 2;
  const auto [still, either_way, settling] = waits(axes, kicks, theta_N, holding_N);
  rest_is_seen = std::max(still, either_way) + settling < longest_count / 2;
  // The very number that the controller commands, which compares its force with it: whole steps, rounded once.
  const auto step_N = static_cast<Real>(axes.force_step_N);
  const Real brake_N = static_cast<Real>(std::round(b / axes.force_step_N)) * step_N;
  const auto exact = [&](double force_N) { return force_N == -b ? -brake_N : static_cast<Real>(force_N); };
  return {.brake_N = brake_N,
          .force_step_N = step_N,
          .preload_N = exact(kicks.preload_N()),
          .resting_force_N = exact(theta_N),
          .holding_force_N = static_cast<Real>(holding_N),
          .fast_lag = share_left<Real>(axes.period_s, axes.lag_s.least, Real{0}),
          .slow_lag = share_left<Real>(axes.period_s, axes.lag_s.most, Real{1}),
          .coast_per_N = static_cast<Real>(gains / (kicks.least_friction_N() + axes.force_gain.least * b)),
          .least_seen_N = {},
          .most_seen_N = {},
          .still_periods = counted(still),
          .either_way_periods = counted(either_way),
          .patient_periods = counted(std::max(still, either_way) + 30 + axes.latency_periods + settling),
          .settling_periods = counted(settling),
          .approach = approach<Real>(axes, kicks),
          .table = {}};
}

}  // namespace

template <class Real>
BrakedDesign<Real> design_braked_kicks(const BrakedClass& axes) {
  const KickClass kicks{axes};
  BrakedDesign<Real> design;
  const double A = kicks.least_friction_N();
  design.floor_m = design.pulse_needed_N = infinity;
  design.brake_holds = A > 0 && axes.force_gain.most * kicks.brake_N() < A;
  if (!design.brake_holds) return design;
  const LeastPulse least = least_pulse(kicks);
  design.pulse_needed_N = least.force_N;
  design.breaks_away = std::isfinite(least.distance_m);
  if (!design.breaks_away) return design;

  detail::KickTableBuilder<Real> builder{axes, kicks};
  builder.build(std::max(least.distance_m, axes.encoder_resolution_m / 2));
  design.kicks = numbers<Real>(axes, kicks, design.rest_is_seen);
  design.kicks.table = builder.table();
  design.kicks.least_seen_N = static_cast<Real>(builder.seen_N().least);
  design.kicks.most_seen_N = static_cast<Real>(builder.seen_N().most);
  const Interval range = builder.range_m();
  design.floor_m = range.least;
  design.reach_m = range.most;
  design.aim_lost = builder.aim_lost();
  design.peak_speed_m_s = builder.peak_speed_m_s();
  design.table_bytes = sizeof(design.kicks.table);
  design.least_tolerance_m = std::max(design.floor_m, 0.51 * axes.encoder_resolution_m);
  return design;
}

template <class Real>
int most_kicks(const BrakedClass& axes, const BrakedDesign<Real>& design, double distance_m, double tolerance_m) {
  if (!design.possible() || tolerance_m < design.least_tolerance_m * (1 - 1e-9)) return 0;
  const detail::WorstKicks worst{axes, design.kicks.table, tolerance_m, std::max(design.reach_m, tolerance_m)};
  int count = 0;
  double error_m = distance_m;
  while (error_m + axes.encoder_resolution_m / 2 > tolerance_m) {
    const double next_m = worst.after(error_m);
    if (!(next_m < error_m) || ++count > most_counted) return 0;
    error_m = next_m;
  }
  return count;
}

template struct BrakedDesign<float>;
template struct BrakedDesign<double>;
template BrakedDesign<float> design_braked_kicks(const BrakedClass&);
template BrakedDesign<double> design_braked_kicks(const BrakedClass&);
template int most_kicks(const BrakedClass&, const BrakedDesign<float>&, double, double);
template int most_kicks(const BrakedClass&, const BrakedDesign<double>&, double, double);

}  // namespace breakaway::design
