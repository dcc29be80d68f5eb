#include "switches.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace breakaway::evaluation {
namespace {

constexpr std::size_t least_readings = 16, most_readings = 60;
constexpr int most_latency_periods = 8;

std::optional<Switch> switch_between(const Record& record, const Stretch& a, const Stretch& b, const Look& look) {
  if (a.last != b.first || a.first + look.settling + least_readings > a.last) return {};
  const Motion before = motion_in(record, a.first + look.settling, a.last);
  const Motion after = motion_in(record, b.first + look.settling, b.last);
  // One that does not move has no motion up to a.last.
  if (before.last + 2 < a.last || before.direction != after.direction) return {};
  const std::size_t n_before = a.last - before.first, n_after = after.last - after.first;
  if (n_after < least_readings) return {};
  const auto with = [&](std::size_t n) {
    return Switch{.at = b.first,
                  .readings = std::min({n, n_before, n_after}),
                  .from = before.first,
                  .to = after.last,
                  .change_N = b.command_N - a.command_N,
                  .before = fit(record, a.last - std::min(n_before, n), a.last),
                  .after = fit(record, after.first, after.first + std::min(n_after, n))};
  };
  const Switch found = with(most_readings);
  if (!(found.change_N * found.change_m_s2() > 0 && std::abs(found.change_m_s2()) > 50 * found.error_m_s2())) return {};
  // Shorter parabolas leave friction less room to change; longer ones see past the counts.
  const double scattered_m =
      std::max(look.scatter_m(record, before.first, a.last), look.scatter_m(record, after.first, after.last));
  const double enough = readings_for(5e-4 * std::abs(found.change_m_s2()), scattered_m, record.period_s);
  return with(static_cast<std::size_t>(
      std::clamp(enough, static_cast<double>(least_readings), static_cast<double>(most_readings))));
}

double residual_m(const Switch& s) { return std::max(s.before.residual_m, s.after.residual_m); }

// Where friction or force steps within a parabola, as it may from place to place, the readings are further off it than
// those of other switches, and its acceleration is that of neither part.
std::vector<Switch> on_parabolas(const std::vector<Switch>& switches, double resolution_m) {
  std::vector<double> residuals_m;
  residuals_m.reserve(switches.size());
  for (const Switch& s : switches) residuals_m.push_back(residual_m(s));
  const double most_m = std::max(resolution_m, 3 * median(residuals_m));
  std::vector<Switch> kept;
  for (const Switch& s : switches)
    if (residual_m(s) <= most_m) kept.push_back(s);
  return kept;
}

// Such a change is among the greatest: of one or two of them the spread says nothing, so that the sixth is the measure.
double great_change_N(const std::vector<Switch>& switches) {
  std::vector<double> changes_N;
  changes_N.reserve(switches.size());
  for (const Switch& s : switches) changes_N.push_back(std::abs(s.change_N));
  const auto sixth = changes_N.begin() + static_cast<std::ptrdiff_t>(std::min(changes_N.size(), least_switches) - 1);
  std::ranges::nth_element(changes_N, sixth, std::greater{});
  return 0.7 * *sixth;
}

std::vector<Switch> greatest(const std::vector<Switch>& switches, double resolution_m) {
  const std::vector<Switch> telling = on_parabolas(switches, resolution_m);
  const double great_N = great_change_N(telling);
  std::vector<Switch> kept;
  for (const Switch& s : telling)
    if (std::abs(s.change_N) > great_N) kept.push_back(s);
  return kept;
}

// What friction changes by during a switch puts its mass off by that over the change of the force. So a smaller switch,
// which may be the only one at its place, says how far a great one would be off there. It is the worst of many places
// already, where the great ones are about one.
double spread_of(const std::vector<Switch>& switches, double mass_kg) {
  const double great_N = great_change_N(switches);
  double spread = 0;
  for (const Switch& s : switches)
    spread = std::max(spread, std::abs(s.mass_kg() / mass_kg - 1) * std::min(std::abs(s.change_N) / great_N, 1.0));
  return spread;
}

// Behind a loop of first order the new parabola goes through a speed of the old one a lag late, and through a place
// that is off by (a2 - a1) lag^2 / 2 there.
struct Meeting {
  double delay_s, lag_squared_s2;
};
Meeting meeting_of(const Switch& s, double T) {
  const double change_m_s2 = s.change_m_s2();
  const double at = static_cast<double>(s.at);
  const double late_s = (s.before.speed_at(at, T) - s.after.speed_at(at, T)) / change_m_s2;
  const double meeting = at + late_s / T;
  const double off_m = s.after.position_at(meeting, T) - s.before.position_at(meeting, T);
  return {late_s, 2 * off_m / change_m_s2};
}

// A mass is the same however long one looks at its motion. A load that swings, and friction that changes on the way,
// are not: by so much do longer and shorter parabolas differ from those that were taken, beyond chance, but for the
// tenth that differ most.
double spread_of_lengths(const std::vector<Switch>& switches, const Record& record) {
  constexpr std::size_t longest_readings = 100;
  std::vector<double> shares;
  for (const Switch& s : switches) {
    const std::size_t room = std::min({s.at - s.from, s.to - s.after.first, longest_readings});
    for (std::size_t n = least_readings; n <= room; n += n / 2) {
      Switch other = s;
      other.before = fit(record, s.at - n, s.at);
      other.after = fit(record, s.after.first, s.after.first + n);
      const double by_chance = 3 * (other.error_m_s2() + s.error_m_s2()) / std::abs(other.change_m_s2());
      shares.push_back(std::max(std::abs(other.mass_kg() / s.mass_kg() - 1) - by_chance, 0.0));
    }
  }
  if (shares.empty()) return 0;
  const auto ninth = shares.begin() + static_cast<std::ptrdiff_t>(shares.size() * 9 / 10);
  std::ranges::nth_element(shares, ninth);
  return *ninth;
}

// Of one delay, how much is whole periods.
struct Parting {
  int periods = 0, fewest = 0, most = 0;
};
// The lag that is left must be the one whose square the switches show, as far as their median is sure: five times its
// standard error, since there are few of them. A loop whose forces begin with the next sample has a latency of 1, which
// is taken where it can be; less is believed only where the delay is too short for it.
Parting parted(double delay_s, const std::vector<double>& lags_squared_s2, double period_s) {
  constexpr int usual_periods = 1;
  const double seen_s2 = median(lags_squared_s2);
  const auto n = static_cast<double>(lags_squared_s2.size());
  double square_s4 = 0;
  for (const double lag_squared_s2 : lags_squared_s2)
    square_s4 += (lag_squared_s2 - seen_s2) * (lag_squared_s2 - seen_s2);
  const double error_s2 = 1.25 * std::sqrt(square_s4) / n;
  const auto off_s2 = [&](int periods) {
    const double lag_s = delay_s - periods * period_s;
    return std::abs(lag_s * std::abs(lag_s) - seen_s2);
  };
  const auto can_be = [&](int periods) { return delay_s - periods * period_s >= -0.35 * period_s; };
  const int least = can_be(usual_periods) ? usual_periods : 0;
  int best = least;
  for (int periods = least + 1; periods <= most_latency_periods && can_be(periods); ++periods)
    if (off_s2(periods) < off_s2(best)) best = periods;
  Parting found{best, best, best};
  for (int periods = least; periods <= most_latency_periods && can_be(periods); ++periods) {
    if (off_s2(periods) > 5 * error_s2) continue;
    found.fewest = std::min(found.fewest, periods);
    found.most = std::max(found.most, periods);
  }
  if (found.fewest <= usual_periods && usual_periods <= found.most) found.periods = usual_periods;
  return found;
}

}  // namespace

Interval range_of(const std::vector<double>& values) {
  Interval range{values.front(), values.front()};
  for (const double value : values) {
    range.least = std::min(range.least, value);
    range.most = std::max(range.most, value);
  }
  return range;
}

std::vector<Switch> switches_in(const Record& record, const std::vector<Stretch>& stretches, const Look& look) {
  std::vector<Switch> found;
  for (std::size_t i = 1; i < stretches.size(); ++i)
    if (const auto one = switch_between(record, stretches[i - 1], stretches[i], look)) found.push_back(*one);
  return found;
}

MassEstimate mass_of(const std::vector<Switch>& switches, const Record& record) {
  std::vector<double> masses;
  for (const Switch& s : greatest(switches, record.resolution_m)) masses.push_back(s.mass_kg());
  const double mass_kg = median(masses);
  return {.mass_kg = mass_kg,
          .seen_kg = range_of(masses),
          .switches = masses.size(),
          .spread = spread_of(on_parabolas(switches, record.resolution_m), mass_kg),
          .spread_of_lengths = spread_of_lengths(switches, record)};
}

LatencyEstimate latency_of(const std::vector<Switch>& switches, const Record& record) {
  const double period_s = record.period_s;
  std::vector<double> delays, lags;
  for (const Switch& s : greatest(switches, record.resolution_m)) {
    const Meeting meeting = meeting_of(s, period_s);
    delays.push_back(meeting.delay_s), lags.push_back(meeting.lag_squared_s2);
  }
  LatencyEstimate latency{.delay_s = median(delays), .delay_seen_s = range_of(delays)};
  const Parting parting = parted(latency.delay_s, lags, period_s);
  latency.periods = parting.periods;
  latency.fewest_periods = parting.fewest;
  latency.most_periods = parting.most;
  latency.lag_s = std::max(latency.delay_s - latency.periods * period_s, 0.0);
  // What friction does within a look puts all switches off alike.
  const double common_s = (0.02 + 2 * spread_of_lengths(switches, record)) * period_s;
  latency.lag_error_s = latency.delay_seen_s.most - latency.delay_seen_s.least + common_s;
  latency.lag_is_seen = latency.is_told_apart() && latency.lag_s > latency.lag_error_s;
  return latency;
}

}  // namespace breakaway::evaluation
