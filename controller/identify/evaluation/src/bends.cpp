#include "bends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <optional>

#include "breakaway/input/input_error.hpp"
#include "constant_force.hpp"

namespace breakaway::evaluation {
namespace {

// Readings first .. last - 1 in which the force changes by little steps only, and not by nothing.
struct SlowForce {
  std::size_t first, last;
};

std::vector<SlowForce> slow_forces_in(const Record& record) {
  constexpr std::size_t least_readings = 60, longest_step = 100;  // readings that one step of force may last
  const auto& readings = record.readings;
  double most_N = 0;
  for (const Reading& reading : readings) most_N = std::max(most_N, std::abs(reading.command_N));
  const double little_N = std::max(2.5 * record.force_step_N, 0.004 * most_N);
  std::vector<SlowForce> found;
  std::size_t first = 0, changed = 0;
  for (std::size_t i = 1; i <= readings.size(); ++i) {
    const double step_N =
        i < readings.size() ? std::abs(readings[i].command_N - readings[i - 1].command_N) : 2 * little_N;
    const bool ends = step_N > little_N || i > changed + longest_step;
    if (ends) {
      if (changed > first + least_readings) found.push_back({first, std::min(i, changed + 1)});
      first = changed = i;
    } else if (step_N > 0) {
      if (changed == first) first = i - 1;
      changed = i;
    }
  }
  return found;
}

std::size_t delay_readings(const Record& record, const Swing& swing) {
  return static_cast<std::size_t>(std::lround(swing.delay_s / record.period_s));
}

// Readings of one slow way, as they were under the forces of `part`, late.
struct Way {
  std::size_t first, last;
  int direction;
};

struct Creep {
  double over_N;   // what the force has more than the spring, on the mean of the latter half of the way
  double slack_N;  // by so much that fell over the last nine tenths
  double force_N;  // by so much the force changed meanwhile
};

// Nothing where the motor crept little, or went faster at the end than along the spring.
std::optional<Creep> creep_in(const Record& record, const Way& way, std::size_t delay, double stiffness_N_per_m) {
  constexpr double least_counts = 4;
  const auto& readings = record.readings;
  const double q = record.resolution_m;
  const auto moved_m = [&](std::size_t i) {
    return way.direction * (readings[i + delay].position_m - readings[way.first + delay].position_m);
  };
  const auto over_N = [&](std::size_t i) {
    return readings[i].command_N - stiffness_N_per_m * readings[i + delay].position_m;
  };
  const std::size_t end = way.last - 1;
  if (way.last + delay > readings.size() || moved_m(end) < least_counts * q) return {};
  const std::size_t tenth = end - (way.last - way.first) / 10;
  const double spring_m = std::abs(readings[end].command_N - readings[tenth].command_N) / stiffness_N_per_m;
  if (moved_m(end) - moved_m(tenth) > 2 * spring_m + 3 * q) return {};
  std::size_t first = way.first;
  while (moved_m(first) < moved_m(end) / 10) ++first;
  double sum_N = 0;
  std::size_t n = 0;
  for (std::size_t i = first; i < way.last; ++i)
    if (moved_m(i) >= moved_m(end) / 2) sum_N += over_N(i), ++n;
  return Creep{sum_N / static_cast<double>(n), way.direction * (over_N(first) - over_N(end)),
               way.direction * (readings[end].command_N - readings[first].command_N)};
}

// The force turned in between, and the motor followed it both ways.
std::optional<Bend> bend_in(const Record& record, const SlowForce& part, std::size_t delay, double stiffness_N_per_m) {
  const auto& readings = record.readings;
  const auto force = [&](std::size_t i) { return readings[i].command_N; };
  const int way = force(std::min(part.first + 20, part.last - 1)) > force(part.first) ? 1 : -1;
  std::size_t top = part.first;
  // The first top: the force that goes on past 0 may be greater the other way.
  while (top + 1 < part.last && way * (force(top + 1) - force(top)) >= 0) ++top;
  if (top < part.first + 10 || top + 10 > part.last) return {};
  const auto there = creep_in(record, {part.first, top + 1, way}, delay, stiffness_N_per_m);
  const auto back = creep_in(record, {top, part.last, -way}, delay, stiffness_N_per_m);
  if (!there || !back) return {};
  return Bend{top, readings[top].position_m, way * (there->over_N - back->over_N) / 2, there->slack_N + back->slack_N,
              there->force_N + back->force_N};
}

std::optional<SprungBreakAway> break_away_in(const Record& record, const SlowForce& part, std::size_t delay,
                                             const Swing& swing, double mass_kg) {
  const auto& readings = record.readings;
  const double T = record.period_s;
  const auto n = static_cast<std::size_t>(std::max(3 * std::numbers::pi / swing.rate_rad_s / T, 16.0));
  const int way = readings[part.last - 1].command_N > readings[part.first].command_N ? 1 : -1;
  for (std::size_t i = part.first + 1; i < part.last; ++i)
    if (way * (readings[i].command_N - readings[i - 1].command_N) < 0) return {};
  if (part.last < part.first + 2 * n + delay) return {};
  SprungBreakAway found{part.last, readings[part.last - 1].position_m, way, 0};
  for (std::size_t first = part.first + delay; first + n <= part.last; ++first) {
    const auto mean = mean_motion(record, first, first + n, swing);
    if (!mean) return {};
    const double force_N = readings[first + n / 2 - delay].command_N;
    found.both_N = std::max(found.both_N, way * (force_N - mass_kg * mean->acceleration_m_s2));
  }
  // It must have gone on by itself at the end.
  const double end_m_s = way * (readings[part.last - 1].position_m - readings[part.last - n].position_m) / T;
  if (end_m_s < 4 * record.resolution_m / T) return {};
  return found;
}

}  // namespace

std::vector<Bend> bends_in(const Record& record, const Swing& swing, double stiffness_N_per_m) {
  std::vector<Bend> found;
  for (const SlowForce& part : slow_forces_in(record))
    if (const auto one = bend_in(record, part, delay_readings(record, swing), stiffness_N_per_m)) found.push_back(*one);
  return found;
}

void require_tight(const std::vector<Bend>& bends, double stiffness_N_per_m, double resolution_m) {
  if (bends.size() < least_bends) return;
  constexpr double softer = 0.2;  // what a swing tells of its own spring is nearer than this
  std::vector<double> slack_N, motor_N, force_N;
  for (const Bend& bend : bends)
    slack_N.push_back(bend.slack_N), motor_N.push_back(bend.motor_N), force_N.push_back(bend.force_N);
  const double lost_N = median(slack_N);
  if (lost_N < -softer * median(force_N) - stiffness_N_per_m * resolution_m)
    throw InputError{fmt::format(
        "in {} bends of the spring the motor moved less than the {:.2g} N/m of the swing that was found let it, so "
        "that "
        "this is another swing than that of the load: give the axis more force, so that its own is seen, or a finer "
        "encoder",
        bends.size(), stiffness_N_per_m)};
  if (lost_N <= 0.05 * median(motor_N) + stiffness_N_per_m * resolution_m) return;
  throw InputError{
      fmt::format("in {} bends of the spring the motor moved {:.2g} m further than the spring gave way, so that the "
                  "joint has play, which this experiment does not identify: take it out, or describe the load by what "
                  "its maker says",
                  bends.size(), lost_N / stiffness_N_per_m)};
}

std::vector<SprungBreakAway> sprung_break_aways_in(const Record& record, const Swing& swing, double mass_kg) {
  std::vector<SprungBreakAway> found;
  for (const SlowForce& part : slow_forces_in(record))
    if (const auto one = break_away_in(record, part, delay_readings(record, swing), swing, mass_kg))
      found.push_back(*one);
  return found;
}

}  // namespace breakaway::evaluation
