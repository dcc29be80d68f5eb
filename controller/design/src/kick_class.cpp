#include "kick_class.hpp"

#include <algorithm>
#include <cmath>

#include "breakaway/design/pulse_travel.hpp"

namespace breakaway::design::detail {
namespace {

constexpr double brake_share = 0.9;     // of the least friction
constexpr double spring_share = 0.75;   // of the same, of a force that bends friction
constexpr double preload_share = 0.1;   // of a brake that no step rounds down, by which a pulse may start below it
constexpr double quick_lag = 0.11;      // in periods: a loop as quick as this may start a pulse from either brake
constexpr double step_rounding = 1e-9;  // relative: a whole number of steps must not lose one
constexpr double cut_rounding = 4e-6;   // relative, of the cut as the controller computes it
constexpr double aimed_within = 1e-10;  // relative, of the root of a distance: far below what a table rounds
constexpr int most_cut_periods = 255;

struct RootEnd {
  double x, value;
};

// Anderson and Bjorck's method: regula falsi, in which an end that stays counts for less each time.
template <class Function>
double rising_root(const Function& f, RootEnd below, RootEnd above, double tolerance) {
  for (int i = 0; i < 60 && above.x - below.x > 4e-16 * above.x; ++i) {
    const double x = above.x - above.value * (above.x - below.x) / (above.value - below.value);
    const RootEnd next{x, f(x)};
    if (std::fabs(next.value) <= tolerance) return x;
    RootEnd& replaced = next.value < 0 ? below : above;
    RootEnd& kept = next.value < 0 ? above : below;
    const double ratio = 1 - next.value / replaced.value;
    kept.value *= ratio > 0 ? ratio : 0.5;
    replaced = next;
  }
  return above.x;
}

// A brake would drive the axis back on what bends.
bool bends(const BrakedClass& axes) { return axes.presliding_stiffness_N_per_m > 0; }

}  // namespace

KickClass::KickClass(const BrakedClass& axes)
    : axes_{axes},
      least_friction_N_{axes.friction.lower_N - axes.load_N},
      most_friction_N_{axes.friction.upper_N + axes.load_N},
      brake_N_{bends(axes) ? 0.0 : std::max(rounded_down_N(brake_share * held_N()), 0.0)},
      spring_N_{bends(axes) ? rounded_down_N(spring_share * held_N()) : 0.0},
      preload_N_{axes.lag_s.most > quick_lag * axes.period_s ? brake_N_ - preload_share * brake_share * held_N()
                                                             : -brake_N_},
      limit_N_{rounded_down_N(axes.max_force_N)} {}

double KickClass::rounded_down_N(double force_N) const {
  return std::floor(force_N / axes_.force_step_N * (1 + step_rounding)) * axes_.force_step_N;
}

double KickClass::cut_N(double force_N, int periods, int cut_periods) const {
  if (axes_.lag_s.least == 0 || cut_periods == 0) return 0;
  const double end_N = force_N + (preload_N_ - force_N) * std::exp(-periods * shortest_period_s() / axes_.lag_s.least);
  const double cut = cut_periods * longest_period_s() / axes_.lag_s.least;
  return (brake_N_ + end_N * std::exp(-cut)) / -std::expm1(-cut);
}

int KickClass::cut_periods(double force_N, int periods) const {
  if (axes_.lag_s.least == 0) return 0;
  int n = 1;
  while (n < most_cut_periods && cut_N(force_N, periods, n) > limit_N_) ++n;
  return n;
}

double KickClass::travel_at(const Corner& corner, double force_N, int periods, int cut_periods, double cut_N) const {
  const double gain = corner.force_gain;
  return travel_m({.start_N = gain * corner.start_N,
                   .pulse_N = gain * force_N,
                   .pulse_s = periods * axes_.period_s + corner.longer_s,
                   .cut_N = gain * cut_N,
                   .cut_s = cut_periods > 0 ? cut_periods * axes_.period_s - corner.longer_s : 0,
                   .brake_N = gain * brake_N_},
                  {corner.mass_kg, corner.friction_N, corner.lag_s});
}

double KickClass::most_travel_m(double force_N, int periods, int cut_periods) const {
  const Corner furthest{axes_.force_gain.most, axes_.mass_kg.least, least_friction_N_,
                        axes_.lag_s.least,     most_start_N(),      axes_.jitter_s};
  const double whole_cut_N = cut_N(force_N, periods, cut_periods);
  const double weakest_cut_N = listed() ? rounded_down_N(whole_cut_N * (1 - cut_rounding))
                                        : whole_cut_N - axes_.force_step_N * (1 + cut_rounding);
  return travel_at(furthest, force_N, periods, cut_periods, weakest_cut_N);
}

double KickClass::least_travel_m(double force_N, int periods, int cut_periods) const {
  const Corner nearest{axes_.force_gain.least, axes_.mass_kg.most, most_friction_N_,
                       axes_.lag_s.most,       preload_N_,         -axes_.jitter_s};
  const double whole_cut_N = cut_N(force_N, periods, cut_periods);
  const double strongest_cut_N = listed() ? rounded_down_N(whole_cut_N * (1 + cut_rounding)) : whole_cut_N;
  return travel_at(nearest, force_N, periods, cut_periods, strongest_cut_N);
}

// Without lag the travel is tau^2 (F - A) (F + b) / (2 m (A + b)), which is a good start with a lag.
double KickClass::force_N(double distance_m, int periods, int cut_periods) const {
  const double gain = axes_.force_gain.most, A = least_friction_N_, b = gain * brake_N_;
  const double pulse_s = periods * axes_.period_s + axes_.jitter_s, m = axes_.mass_kg.least;
  const double g = A + b;
  const double start_N = ((g + std::sqrt(g * g + 8 * g * m * distance_m / (pulse_s * pulse_s))) / 2 - b) / gain;
  if (axes_.lag_s.least == 0) return start_N;
  const auto excess = [&](double force) {
    return std::sqrt(most_travel_m(force, periods, cut_periods)) - std::sqrt(distance_m);
  };
  // The travel grows about as the square of the force beyond A, and its root about in proportion.
  double below = A / gain, above = start_N, at_below = -std::sqrt(distance_m), at_above = excess(above);
  while (at_above < 0) {
    // A pulse that does not move the axis tells nothing of how the travel grows.
    const bool grows = at_above > at_below;
    const double along = grows ? above - at_above * (above - below) / (at_above - at_below) : 2 * above - A / gain;
    below = above, at_below = at_above;
    above = A / gain + 1.02 * (along - A / gain);
    at_above = excess(above);
  }
  return rising_root(excess, {below, at_below}, {above, at_above}, aimed_within * std::sqrt(distance_m));
}

double KickClass::needed_N(int periods) const {
  const double gain = axes_.force_gain.least;
  const double left =
      axes_.lag_s.most > 0 ? std::exp(-(periods * axes_.period_s - axes_.jitter_s) / axes_.lag_s.most) : 0;
  const double needed_N = (surely_above * most_friction_N_ / gain - preload_N_ * left) / (1 - left);
  return std::ceil(needed_N / axes_.force_step_N * (1 - step_rounding)) * axes_.force_step_N;
}

}  // namespace breakaway::design::detail
