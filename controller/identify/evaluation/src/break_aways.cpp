#include "break_aways.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace breakaway::evaluation {
namespace {

constexpr std::size_t rest_readings = 20;

// From the last reading of a rest of 20 readings on a count and its neighbour, the axis goes on by two counts more,
// away from it.
bool sets_off_after(const Record& record, std::size_t last_of_rest) {
  const auto& readings = record.readings;
  const double rest_m = readings[last_of_rest].position_m, q = record.resolution_m;
  const double step_m = readings[last_of_rest + 1].position_m - rest_m;
  if (std::abs(step_m) < q / 2) return false;
  for (std::size_t i = last_of_rest - rest_readings; i < last_of_rest; ++i)
    if (std::abs(readings[i].position_m - rest_m) > q / 2) return false;
  const std::size_t horizon = std::min(last_of_rest + 40, readings.size());
  for (std::size_t i = last_of_rest + 1; i < horizon; ++i) {
    const double away_m = (readings[i].position_m - rest_m) * (step_m > 0 ? 1 : -1);
    if (away_m < q / 2) return false;
    if (away_m > 2.5 * q) return true;
  }
  return false;
}

// The command at a time between two readings.
double command_at(const Record& record, double reading) {
  const auto most = static_cast<double>(record.readings.size() - 1);
  return record.readings[static_cast<std::size_t>(std::clamp(std::floor(reading), 0.0, most))].command_N;
}

std::optional<BreakAway> break_away_at(const Record& record, std::size_t at, const LatencyEstimate& latency,
                                       double mass_kg) {
  const double T = record.period_s, step_m = record.readings[at].position_m - record.readings[at - 1].position_m;
  const int direction = step_m > 0 ? 1 : -1;
  const double late = latency.periods + latency.lag_s / T, seen = static_cast<double>(at) - late;
  if (seen < static_cast<double>(rest_readings)) return {};
  const double force_N = direction * command_at(record, seen);
  const double rate_N_s =
      (force_N - direction * command_at(record, seen - rest_readings)) / (static_cast<double>(rest_readings) * T);
  const bool ramp = rate_N_s > 0 && rate_N_s * static_cast<double>(rest_readings) * T < 0.2 * force_N;
  if (!ramp) return {};
  // Under what a ramp has too much, the axis takes so long for a count at most.
  const double count_s = std::cbrt(6 * mass_kg * record.resolution_m / rate_N_s);
  const double before_N = direction * command_at(record, seen - 1 - count_s / T);
  return BreakAway{at,
                   {.position_m = record.readings[at - 1].position_m,
                    .speed_m_s = 0,
                    .direction = direction,
                    .friction_N = {before_N, force_N},
                    .motion = 0}};
}

// Of one ramp; nothing where it did not begin without force.
std::optional<double> stiffness_before(const Record& record, const BreakAway& one, std::size_t latency) {
  const auto& readings = record.readings;
  const int direction = one.seen.direction;
  const double half_N = one.seen.friction_N.most / 2;
  const auto force_N = [&](std::size_t i) { return direction * readings[i].command_N; };
  std::size_t half = one.at;
  while (half > 0 && force_N(half) > half_N) --half;
  std::size_t first = half;
  while (first > 0 && force_N(first) > 0 && force_N(first) >= force_N(first - 1)) --first;
  if (force_N(first + 1) > 0.1 * half_N || half + latency >= one.at) return {};
  const double bent_m = direction * (readings[half + latency].position_m - readings[first].position_m);
  if (bent_m < 1.5 * record.resolution_m) return {};
  return half_N / (bent_m + record.resolution_m);
}

}  // namespace

std::vector<BreakAway> break_aways_in(const Record& record, const LatencyEstimate& latency, double mass_kg) {
  std::vector<BreakAway> found;
  for (std::size_t i = rest_readings; i + 1 < record.readings.size(); ++i) {
    if (!sets_off_after(record, i)) continue;
    if (const auto one = break_away_at(record, i + 1, latency, mass_kg)) found.push_back(*one);
  }
  return found;
}

std::optional<double> presliding_stiffness_N_per_m(const Record& record, const std::vector<BreakAway>& broken,
                                                   const LatencyEstimate& latency) {
  std::optional<double> least;
  for (const BreakAway& one : broken) {
    const auto stiffness = stiffness_before(record, one, static_cast<std::size_t>(latency.periods));
    if (stiffness && (!least || *stiffness < *least)) least = stiffness;
  }
  return least;
}

}  // namespace breakaway::evaluation
