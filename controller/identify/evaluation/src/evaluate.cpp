#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "break_aways.hpp"
#include "breakaway/evaluation/identification.hpp"
#include "breakaway/input/input_error.hpp"
#include "constant_force.hpp"
#include "switches.hpp"

namespace breakaway::evaluation {
namespace {

struct Friction {
  const Record& record;
  double mass_kg, mass_error;
  double usual_N;  // friction, roughly
  Settling settling;
  std::vector<FrictionSample> samples;

  // From one parabola.
  void add(const Parabola& p, double command_N, int direction) {
    const double friction_N = direction * (command_N - mass_kg * p.acceleration_m_s2);
    const double error_N = mass_kg * (3 * p.error_m_s2 + mass_error * std::abs(p.acceleration_m_s2));
    if (error_N > 0.05 * usual_N) return;
    samples.push_back({.position_m = p.position_m,
                       .speed_m_s = p.speed_m_s,
                       .direction = direction,
                       .friction_N = {friction_N - error_N, friction_N + error_N},
                       .motion = 0});
  }
  void add(const Stretch& stretch) {
    const Motion motion = motion_in(record, stretch.first + settling.all, stretch.last);
    if (motion.direction == 0) return;
    // The axis may have come to rest within the last count.
    std::size_t last = motion.last;
    const double end_m = record.readings[last - 1].position_m;
    while (last > motion.first && std::abs(record.readings[last - 1].position_m - end_m) < 2 * record.resolution_m)
      --last;
    const auto wanted =
        static_cast<std::size_t>(std::clamp(readings_for(0.01 * usual_N / mass_kg, record), 16.0, 200.0));
    if (last < motion.first + 16) return;
    const std::size_t parts = std::max<std::size_t>((last - motion.first) / wanted, 1);
    const std::size_t length = (last - motion.first) / parts;
    for (std::size_t i = 0; i < parts; ++i)
      add(fit(record, last - (parts - i) * length, last - (parts - 1 - i) * length), stretch.command_N,
          motion.direction);
  }
};

// From rest to rest, in the order of time; a sample belongs to the motion that it is in.
void number_motions(Identification& found) {
  std::size_t motion = 0;
  int direction = 0;
  double position_m = 0;
  for (FrictionSample& sample : found.friction) {
    const bool goes_on =
        sample.direction == direction && sample.speed_m_s != 0 && direction * (sample.position_m - position_m) >= 0;
    if (!goes_on) ++motion;
    sample.motion = motion;
    direction = sample.direction;
    position_m = sample.position_m;
  }
  found.motions = motion;
}

void sum_up(Identification& found, const Margins& margins) {
  constexpr double far = std::numeric_limits<double>::infinity();
  found.friction_seen_N = {far, -far};
  found.travel_seen_m = {far, -far};
  for (const FrictionSample& sample : found.friction) {
    found.friction_seen_N.least = std::min(found.friction_seen_N.least, sample.friction_N.least);
    found.friction_seen_N.most = std::max(found.friction_seen_N.most, sample.friction_N.most);
    found.travel_seen_m.least = std::min(found.travel_seen_m.least, sample.position_m);
    found.travel_seen_m.most = std::max(found.travel_seen_m.most, sample.position_m);
  }
  found.bounds_N = {found.friction_seen_N.least * (1 - margins.friction),
                    found.friction_seen_N.most * (1 + margins.friction)};
  const MassEstimate& mass = found.mass;
  const double spread = std::max(mass.seen_kg.most - mass.mass_kg, mass.mass_kg - mass.seen_kg.least) / mass.mass_kg;
  found.mass_uncertainty = std::max(margins.mass, 2 * spread);
}

void require_readable(const Record& record) {
  if (record.readings.size() < 200)
    throw InputError{"the record has fewer than 200 readings: record the whole experiment"};
  if (!(record.period_s > 0 && record.resolution_m > 0 && record.force_step_N > 0))
    throw InputError{"the record needs a period, a count and a step of force above 0: check [loop] and [drive]"};
}

// A mass under constant force and friction draws parabolas, but for what friction changes on the way.
void require_rigid(const std::vector<Switch>& switches, const Record& record) {
  std::vector<double> residuals_m, shares;
  for (const Switch& s : switches) {
    const double half_s = static_cast<double>(s.readings) / 2 * record.period_s;
    residuals_m.push_back(std::max(s.before.residual_m, s.after.residual_m));
    shares.push_back(residuals_m.back() / (std::abs(s.change_m_s2()) / 2 * half_s * half_s));
  }
  const double residual_m = median(residuals_m);
  if (residual_m < 10 * record.resolution_m || median(shares) < 0.01) return;
  throw InputError{fmt::format(
      "under a constant force the positions are {:.2g} m off a parabola, so that the axis is no single mass: a load "
      "swings "
      "on a spring or has play, which this experiment does not identify; take the coast \"work\" and the load's data",
      residual_m)};
}

// Friction takes energy, so it never comes out at 0 or below where nothing else pushes the axis.
void require_friction(const Identification& found) {
  if (found.friction_seen_N.least > 0) return;
  throw InputError{fmt::format(
      "friction comes out at {:.4g} N at the least, and it cannot be 0 or less, so that something else pushes the "
      "axis: "
      "a load swings on a spring, or a weight pulls; for a load take the coast \"work\" and the load's data, and "
      "balance a weight, or lock what swings",
      found.friction_seen_N.least)};
}

}  // namespace

Identification evaluate(const Record& record, const Margins& margins) {
  require_readable(record);
  const std::vector<Stretch> stretches = stretches_of(record);
  Settling settling;
  std::vector<Switch> switches = switches_in(record, stretches, settling);
  if (switches.empty())
    throw InputError{
        "the record has no switch from one constant force to another during a motion, so that nothing tells the mass: "
        "record an experiment, or give the axis more travel and speed, or a finer encoder"};
  Identification found;
  found.duration_s = static_cast<double>(record.readings.size()) * record.period_s;
  // What the first look says of latency and lag tells the second one from where on a parabola is one.
  for (int look = 0; look < 2; ++look) {
    found.latency = latency_of(switches, record.period_s);
    settling.latency = static_cast<std::size_t>(found.latency.periods);
    settling.all =
        settling.latency + 1 + static_cast<std::size_t>(std::ceil(6 * found.latency.lag_s / record.period_s));
    const std::vector<Switch> again = switches_in(record, stretches, settling);
    if (!again.empty()) switches = again;
  }
  found.latency = latency_of(switches, record.period_s);
  found.mass = mass_of(switches);
  require_rigid(switches, record);
  const double m = found.mass.mass_kg;
  const std::vector<BreakAway> broken = break_aways_in(record, found.latency, m);
  if (broken.empty())
    throw InputError{
        "the record has no slow ramp of force that ends a rest, so that nothing tells the friction at rest: "
        "record an experiment"};
  found.presliding_N_per_m = presliding_stiffness_N_per_m(record, broken, found.latency);
  std::vector<double> at_rest_N;
  at_rest_N.reserve(broken.size());
  for (const BreakAway& one : broken) at_rest_N.push_back(one.seen.friction_N.most);
  Friction friction{record, m, 0.005, std::ranges::min(at_rest_N), settling, {}};
  std::size_t next = 0;
  for (const Stretch& stretch : stretches) {
    for (; next < broken.size() && broken[next].at < stretch.first; ++next)
      friction.samples.push_back(broken[next].seen);
    friction.add(stretch);
  }
  for (; next < broken.size(); ++next) friction.samples.push_back(broken[next].seen);
  found.friction = std::move(friction.samples);
  number_motions(found);
  found.margins = margins;
  sum_up(found, margins);
  require_friction(found);
  return found;
}

}  // namespace breakaway::evaluation
