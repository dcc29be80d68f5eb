#include "bent_kicks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "kick_class.hpp"
#include "memo.hpp"

namespace breakaway::design::detail {
namespace {

constexpr double radians_per_slice = 0.2;
constexpr int most_slices = 2000;  // of one push
constexpr int most_rings = 500;
constexpr double spacing = 1.2;     // of the places that kicks are tried from
constexpr double beyond = 4;        // times as far away as the spring leads
constexpr double most_bends = 100;  // from further away a kick hardly notices that friction bends first
// Told is a lower bound of the stiffness: friction that is some times as stiff bends by as much less, and the spring
// leads an axis less far.
constexpr double stiffer_ahead[] = {1, 2.5, 10, 40}, stiffer_back[] = {1, 2.5};

// A mass on bristles of one stiffness and one level, followed by slices in each of which the bend relaxes in closed
// form.
struct Bristled {
  double mass_kg, level_N, stiffness_N_per_m, load_N, lag_s;
  double back_N;  // the level of friction against motion the other way
  double drive_N = 0;
  double x_m = 0, v_m_s = 0;
  double bend_m = 0;

  double omega() const { return std::sqrt(stiffness_N_per_m / mass_kg); }
  double rest_bend_m() const { return load_N / stiffness_N_per_m; }
  // Without the drive, and by an amplitude of more than this, if it does not slide.
  bool rings(double amplitude_m) const {
    return std::hypot(v_m_s / omega(), bend_m - rest_bend_m()) >
           std::min(amplitude_m, std::min(level_N, back_N) / stiffness_N_per_m / 2);
  }

  void push(double to_N, double time_s) {
    const double whole = std::clamp(std::ceil(time_s * omega() / radians_per_slice), 8.0, double{most_slices});
    const double h = time_s / whole, left = lag_s > 0 ? std::exp(-h / lag_s) : 0;
    const double owed = lag_s > 0 ? (1 - left) * lag_s / h : 0;  // share of the change, on average over a slice
    for (int i = 0; i < static_cast<int>(whole); ++i) {
      const double mean_N = to_N + (drive_N - to_N) * owed, before_m_s = v_m_s;
      drive_N = to_N + (drive_N - to_N) * left;
      bend(h / 2);
      v_m_s += (mean_N + load_N - stiffness_N_per_m * bend_m) * h / mass_kg;
      bend(h / 2);
      x_m += h * (before_m_s + v_m_s) / 2;
    }
  }

 private:
  void bend(double h) {
    const double end_N = v_m_s > 0 ? level_N : -back_N;
    bend_m += (bend_m - end_N / stiffness_N_per_m) * std::expm1(-stiffness_N_per_m * std::abs(v_m_s * h / end_N));
  }
};

template <class Real>
class BentKickTrial {
 public:
  BentKickTrial(const BrakedClass& axes, const law::BrakedKicks<Real>& kicks)
      : axes_{axes}, flashed_{kicks}, class_{axes}, spring_N_{axes.force_gain.least * class_.spring_N()} {}

  // Under the least friction, and a load that pushes it on; less the way on which the spring leads it back.
  double furthest_m(double from_m) const {
    double furthest_m = 0;
    for (const double times : stiffer_ahead) {
      Bristled axis{axes_.mass_kg.least, axes_.friction.lower_N, times * axes_.presliding_stiffness_N_per_m,
                    axes_.load_N,        axes_.lag_s.least,      axes_.friction.lower_N};
      const bool is_led = from_m < static_cast<double>(flashed_.spring.reach_m);
      const double ahead_m = travel_m(axis, from_m, axes_.force_gain.most, is_led ? spring_N_ : 0);
      axis.load_N = -axes_.load_N;
      furthest_m = std::max(furthest_m, ahead_m - (is_led ? led_by_spring_m(axis) : 0));
    }
    return furthest_m;
  }

  // Under the greatest friction, on its way back perhaps under the least, and a load that pushes it back; by a kick and
  // the spring that leads it before and after.
  double least_on_m(double from_m) const {
    double least_m = std::numeric_limits<double>::infinity();
    for (const double times : stiffer_back) {
      for (const double back_N : {axes_.friction.upper_N, axes_.friction.lower_N}) {
        const Bristled axis{axes_.mass_kg.most, axes_.friction.upper_N, times * axes_.presliding_stiffness_N_per_m,
                            -axes_.load_N,      axes_.lag_s.most,       back_N};
        const double led_m = led_by_spring_m(axis);
        const bool is_led = from_m + led_m < static_cast<double>(flashed_.spring.reach_m);
        const double by_kick_m = travel_m(axis, from_m, axes_.force_gain.least, is_led ? spring_N_ : 0);
        least_m = std::min(least_m, by_kick_m + (is_led ? led_m : 0));
      }
    }
    return least_m;
  }

  // The least by a kick on friction that holds at once.
  double unbent_m(double from_m) const {
    const Kick kick = kick_from(from_m);
    return class_.least_travel_m(kick.force_N, kick.periods, kick.cut_periods);
  }

 private:
  // As the controller gives it within its limit.
  struct Kick {
    double force_N;
    int periods, cut_periods;
  };
  Kick kick_from(double reading_m) const {
    const law::Pulse<Real> pulse = flashed_.table.pulse(static_cast<Real>(reading_m));
    return {std::min(static_cast<double>(pulse.force_N), class_.limit_N()), pulse.periods, pulse.cut_periods};
  }

  // Dahl's friction bends by s0 dz = (1 - s0 z / f) s0 dx.
  double led_by_spring_m(const Bristled& axis) const {
    const double from_N = axis.level_N - axis.load_N;
    return axis.level_N / axis.stiffness_N_per_m * std::log(from_N / (from_N - spring_N_));
  }

  // From rest under what the drive holds it by to rest without the drive.
  double travel_m(Bristled axis, double from_m, double gain, double held_N) const {
    const auto [force_N, periods, cut_periods] = kick_from(from_m);
    const double cut_N = class_.cut_N(force_N, periods, cut_periods);
    axis.drive_N = held_N;
    axis.bend_m = (held_N + axis.load_N) / axis.stiffness_N_per_m;
    axis.push(gain * force_N, periods * axes_.period_s);
    if (cut_N > 0) axis.push(-gain * cut_N, cut_periods * axes_.period_s);
    const double half_ring_s = std::numbers::pi / axis.omega();
    for (int i = 0; i < 2 * most_rings && axis.rings(axes_.encoder_resolution_m / 2); ++i) axis.push(0, half_ring_s);
    return axis.x_m - (axis.bend_m - axis.rest_bend_m());
  }

  const BrakedClass& axes_;
  const law::BrakedKicks<Real>& flashed_;
  KickClass class_;
  double spring_N_;  // as the axis feels it, at least
};

template <class Real>
BentKicks tried(const BrakedClass& axes, const law::BrakedKicks<Real>& kicks, double tolerance_m) {
  const BentKickTrial<Real> trial{axes, kicks};
  const double led_m = static_cast<double>(kicks.spring.reach_m);
  const double nearest_m = std::max(tolerance_m, 0.55 * axes.encoder_resolution_m);
  BentKicks all;
  all.furthest_from_m = all.least_on_from_m = nearest_m;
  const double least_N = axes.friction.lower_N - axes.load_N, count_m = axes.encoder_resolution_m;
  if (least_N > 1.01 * most_bending_counts * axes.presliding_stiffness_N_per_m * count_m) return all;
  all.spring_back_m = axes.friction.upper_N / axes.presliding_stiffness_N_per_m;
  const double end_m = std::min(beyond * std::max(led_m, nearest_m), most_bends * all.spring_back_m);
  for (double from_m = nearest_m; from_m < end_m; from_m *= spacing) {
    const double on_m = trial.least_on_m(from_m), furthest = trial.furthest_m(from_m) / from_m;
    all.tried_from_m.push_back(from_m);
    all.lost_m.push_back(trial.unbent_m(from_m) - on_m);
    if (on_m < all.least_on * from_m) all.least_on = on_m / from_m, all.least_on_from_m = from_m;
    if (furthest > all.furthest) all.furthest = furthest, all.furthest_from_m = from_m;
  }
  return all;
}

}  // namespace

double BentKicks::led_on_m(double from_m, double travel_m) const {
  const auto next = std::ranges::upper_bound(tried_from_m, from_m) - tried_from_m.begin();
  const auto i = static_cast<std::size_t>(next);
  if (i == tried_from_m.size()) return travel_m - spring_back_m;
  return travel_m - std::max({0.0, lost_m[i], i > 0 ? lost_m[i - 1] : 0});
}

template <class Real>
BentKicks try_bent_kicks(const BrakedClass& axes, const law::BrakedKicks<Real>& kicks, double tolerance_m) {
  static Memo<std::pair<BrakedClass, double>, BentKicks> memo;
  return memo.of({axes, tolerance_m}, [&](const auto&) { return tried(axes, kicks, tolerance_m); });
}

template BentKicks try_bent_kicks(const BrakedClass&, const law::BrakedKicks<float>&, double);
template BentKicks try_bent_kicks(const BrakedClass&, const law::BrakedKicks<double>&, double);

}  // namespace breakaway::design::detail
