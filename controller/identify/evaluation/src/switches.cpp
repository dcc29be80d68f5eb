#include "switches.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace breakaway::evaluation {
namespace {

constexpr std::size_t least_readings = 16, most_readings = 60;
constexpr int most_latency_periods = 8;

std::optional<Switch> switch_between(const Record& record, const Stretch& a, const Stretch& b,
                                     const Settling& settling) {
  if (a.last != b.first || a.first + settling.all + least_readings > a.last) return {};
  const Motion before = motion_in(record, a.first + settling.all, a.last);
  const Motion after = motion_in(record, b.first + settling.all, b.last);
  // One that does not move has no motion up to a.last.
  if (before.last + 2 < a.last || before.direction != after.direction) return {};
  const std::size_t n_before = a.last - before.first, n_after = after.last - after.first;
  if (n_after < least_readings) return {};
  const auto with = [&](std::size_t n) {
    return Switch{.at = b.first,
                  .readings = std::min({n, n_before, n_after}),
                  .change_N = b.command_N - a.command_N,
                  .before = fit(record, a.last - std::min(n_before, n), a.last),
                  .after = fit(record, after.first, after.first + std::min(n_after, n))};
  };
  const Switch found = with(most_readings);
  if (!(found.change_N * found.change_m_s2() > 0 && std::abs(found.change_m_s2()) > 50 * found.error_m_s2())) return {};
  // Shorter parabolas leave friction less room to change; longer ones see past the counts.
  const auto enough = static_cast<std::size_t>(readings_for(5e-4 * std::abs(found.change_m_s2()), record));
  return with(std::clamp(enough, least_readings, most_readings));
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

}  // namespace

Interval range_of(const std::vector<double>& values) {
  Interval range{values.front(), values.front()};
  for (const double value : values) {
    range.least = std::min(range.least, value);
    range.most = std::max(range.most, value);
  }
  return range;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

std::vector<Switch> switches_in(const Record& record, const std::vector<Stretch>& stretches, const Settling& settling) {
  std::vector<Switch> found;
  for (std::size_t i = 1; i < stretches.size(); ++i)
    if (const auto one = switch_between(record, stretches[i - 1], stretches[i], settling)) found.push_back(*one);
  return found;
}

MassEstimate mass_of(const std::vector<Switch>& switches, const Record& record) {
  std::vector<double> masses;
  for (const Switch& s : greatest(switches, record.resolution_m)) masses.push_back(s.mass_kg());
  const double mass_kg = median(masses);
  return {mass_kg, range_of(masses), masses.size(), spread_of(on_parabolas(switches, record.resolution_m), mass_kg)};
}

LatencyEstimate latency_of(const std::vector<Switch>& switches, const Record& record) {
  const double period_s = record.period_s;
  std::vector<double> delays, lags;
  for (const Switch& s : greatest(switches, record.resolution_m)) {
    const Meeting meeting = meeting_of(s, period_s);
    delays.push_back(meeting.delay_s), lags.push_back(meeting.lag_squared_s2);
  }
  LatencyEstimate latency{.delay_s = median(delays), .delay_seen_s = range_of(delays)};
  const double lag_squared_s2 = median(lags);
  double least = INFINITY;
  for (int periods = 0; periods <= most_latency_periods; ++periods) {
    const double lag_s = latency.delay_s - periods * period_s;
    if (lag_s < -0.35 * period_s) break;
    const double off = std::abs(lag_s * std::abs(lag_s) - lag_squared_s2);
    if (!(off < least)) continue;
    least = off;
    latency.periods = periods;
    latency.lag_s = std::max(lag_s, 0.0);
  }
  for (double& delay_s : delays) delay_s = std::abs(delay_s - latency.delay_s);
  latency.lag_error_s = median(delays);
  latency.lag_is_seen = latency.lag_s > std::max(0.05 * period_s, 3 * latency.lag_error_s);
  return latency;
}

}  // namespace breakaway::evaluation
