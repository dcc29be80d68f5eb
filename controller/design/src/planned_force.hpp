// What an approach plans against what the axes of a class do of it.
#pragma once

#include <algorithm>
#include <limits>

#include "kick_class.hpp"

namespace breakaway::design::detail {

// So many times as far away as the brake takes over may an approach end, and a move go beyond its target: tested.
constexpr double hand_overs_beyond = 10;

// So many times as far away may the last approach that the law tries leave an axis: behind a latency one from rest ends
// where the axis is expected to be under its least friction.
constexpr double left_beyond = 1.01;

// Samples, as in a long approach happens now and then.
constexpr double lost_in_a_row = 2;

inline double middle(const Interval& interval) { return (interval.least + interval.most) / 2; }

// How far what is told may be off, relative, either way.
inline double spread(const Interval& interval) {
  return (interval.most - interval.least) / (interval.most + interval.least);
}

// What readings may differ by while they count as unchanged, and the reading errors at both ends.
inline double unseen_m(const BrakedClass& axes) { return axes.encoder_resolution_m + 2 * axes.flicker_m(); }

// Planned is u = m a + A' for the mass m that is told, and what acts is between these.
struct PlannedForce {
  double told_kg, least_N, most_N, gain_least, gain_most, lightest_kg, heaviest_kg, rounding_N;

  PlannedForce(const BrakedClass& axes, const KickClass& kicks)
      : told_kg{middle(axes.mass_kg)},
        least_N{kicks.least_friction_N()},
        most_N{kicks.most_friction_N()},
        gain_least{axes.force_gain.least},
        gain_most{axes.force_gain.most},
        lightest_kg{axes.mass_kg.least},
        heaviest_kg{axes.mass_kg.most},
        rounding_N{axes.force_step_N / 2} {}

  // The most that may be planned where no axis of the class is to exceed `limit`.
  double acceleration(double limit) const {
    return ((limit * lightest_kg + least_N) / gain_most - least_N - rounding_N) / told_kg;
  }
  double deceleration(double limit) const {
    return ((limit * lightest_kg - most_N) / gain_most + least_N - rounding_N) / told_kg;
  }
  // The most that an axis does when this is planned, and the least.
  double exceeded_by(double acceleration) const {
    return (gain_most * (told_kg * acceleration + least_N + rounding_N) - least_N) / lightest_kg;
  }
  double sure_acceleration(double planned) const {
    return (gain_least * (told_kg * planned + least_N - rounding_N) - most_N) / heaviest_kg;
  }
  // What must be planned so that every axis of the class breaks away.
  double needed_acceleration() const { return (surely_above * most_N / gain_least + rounding_N - least_N) / told_kg; }
  double sure_deceleration(double planned) const { return gain_least * told_kg / heaviest_kg * planned; }
};

// What Real rounds away of the way in a period beside a count, of an axis this far from its target: half a last digit
// of the position error at either end.
template <class Real>
double rounded_away_m(const BrakedClass& axes, double away_m) {
  const double rounded_m = away_m * static_cast<double>(std::numeric_limits<Real>::epsilon());
  return std::max(rounded_m - axes.encoder_resolution_m, 0.0);
}

// By how much an axis may go slower than its plan leads it, while the force hardly changes: what leads it there within
// the response time, what its readings say too much of an axis whose friction is not the least, a reading that is off,
// and two samples that are lost in a row, as in a long approach happens now and then. away_m: from its target.
template <class Real>
double slower_than_planned_m_s(const BrakedClass& axes, const law::BrakedApproach<Real>& plan, double away_m = 0) {
  const double response_s = static_cast<double>(plan.response_s), correction = static_cast<double>(plan.correction);
  const double unseen_s = axes.period_s * (1 / correction - 0.5 + axes.latency_periods);
  const double misread_m = unseen_m(axes) + rounded_away_m<Real>(axes, away_m);
  const double misread_m_s = correction * misread_m / axes.period_s, lost_s = lost_in_a_row * axes.period_s;
  return PlannedForce{axes, KickClass{axes}}.needed_acceleration() * (response_s + unseen_s + lost_s) +
         misread_m_s * (1 + lost_s / response_s);
}

// By how much an axis may go faster than its plan lets it: what the greatest gain and the least mass add until readings
// show it, a reading that is off, what a lagging force goes on to add, a friction that falls until it is answered, and
// what the axis seems slower by where a sample is late.
template <class Real>
double faster_than_planned_m_s(const BrakedClass& axes, const law::BrakedApproach<Real>& plan, double allowed_m_s,
                               double away_m) {
  constexpr double more = 2, goes_on = 0.25, rounding = 0.01;  // tested
  const KickClass kicks{axes};
  const PlannedForce force{axes, kicks};
  const double response_s = static_cast<double>(plan.response_s), correction = static_cast<double>(plan.correction);
  const double late_s = axes.latency_periods * axes.period_s,
               unseen_s = axes.period_s * (1 / correction - 0.5) + late_s;
  const double planned = std::min((kicks.limit_N() - force.least_N) / force.told_kg, allowed_m_s / response_s);
  const double misread_m_s = correction * (unseen_m(axes) + rounded_away_m<Real>(axes, away_m)) / axes.period_s;
  // The last force before the limit adds more than it was to, and was to add what the one before is not yet seen to
  // have.
  const double known_gain = force.gain_most * force.told_kg / force.lightest_kg;
  const double adds_s = std::max(more * unseen_s, response_s + known_gain * unseen_s);
  return (force.exceeded_by(planned) - planned) * adds_s + more * (force.exceeded_by(0) * response_s + misread_m_s) +
         goes_on * planned * axes.lag_s.most +
         (force.most_N - force.least_N) / force.lightest_kg * (response_s + late_s) +
         (axes.jitter_s / axes.period_s + rounding) * allowed_m_s;
}

}  // namespace breakaway::design::detail
