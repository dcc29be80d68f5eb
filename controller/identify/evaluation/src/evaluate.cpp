#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "break_aways.hpp"
#include "breakaway/evaluation/identification.hpp"
#include "breakaway/input/input_error.hpp"
#include "constant_force.hpp"
#include "sprung.hpp"
#include "switches.hpp"
#include "totals.hpp"

namespace breakaway::evaluation {
namespace {

struct Friction {
  const Record& record;
  double mass_kg, mass_error;
  double usual_N;  // friction, roughly
  Look look;
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
    const Motion motion = motion_in(record, stretch.first + look.settling, stretch.last);
    if (motion.direction == 0) return;
    // The axis may have come to rest within the last count.
    std::size_t last = motion.last;
    const double end_m = record.readings[last - 1].position_m;
    while (last > motion.first && std::abs(record.readings[last - 1].position_m - end_m) < 2 * record.resolution_m)
      --last;
    const double enough =
        readings_for(0.01 * usual_N / mass_kg, look.scatter_m(record, motion.first, last), record.period_s);
    const auto wanted = static_cast<std::size_t>(std::clamp(enough, 16.0, 200.0));
    if (last < motion.first + 16) return;
    const std::size_t parts = std::max<std::size_t>((last - motion.first) / wanted, 1);
    const std::size_t length = (last - motion.first) / parts;
    for (std::size_t i = 0; i < parts; ++i)
      add(fit(record, last - (parts - i) * length, last - (parts - 1 - i) * length), stretch.command_N,
          motion.direction);
  }
};

void require_readable(const Record& record) {
  if (record.readings.size() < 200)
    throw InputError{"the record has fewer than 200 readings: record the whole experiment"};
  if (!(record.period_s > 0 && record.resolution_m > 0 && record.force_step_N > 0))
    throw InputError{"the record needs a period, a count and a step of force above 0: check [loop] and [drive]"};
}

// A record whose positions were read long after they were stamped, or whose columns were shifted.
void require_causal(const LatencyEstimate& latency, double period_s) {
  if (latency.delay_s > -0.35 * period_s) return;
  throw InputError{
      fmt::format("the positions follow the force {:.2g} s before it is commanded: a load swings on a spring, or the "
                  "columns are of different periods; record both in the period in which the command is computed from "
                  "the position",
                  -latency.delay_s)};
}

void require_sure_mass(const Identification& found) {
  constexpr double most_uncertain = 0.2;
  if (found.mass_uncertainty <= most_uncertain) return;
  throw InputError{fmt::format(
      "the mass is sure to within {:.2g} of it only: longer and shorter looks at the switches of the force differ, "
      "because a load swings on a spring, the joint has play, or friction changes fast; for a load behind a motor with "
      "the encoder describe it roughly in a table [plant.load], and identify again",
      found.mass_uncertainty)};
}

void require_enough(std::size_t switches, std::size_t telling) {
  if (telling >= least_switches) return;
  throw InputError{fmt::format(
      "of {} switches of the force in motion {} tell the mass, and {} are needed, so that their spread says how sure "
      "it is: record a whole experiment, or accelerate and brake {} times or more, at several places of the travel",
      switches, telling, least_switches, least_switches)};
}

// Readings at uneven times are off a smooth motion by chance, each by its own. A swing, play and friction that changes
// are off it in a pattern, which readings repeat that are apart by some number: by more than chance has them.
bool are_off_by_chance(const std::vector<Switch>& switches, const Record& record) {
  std::array<double, 21> products{};  // by how far the readings are apart, as shares of a square of each parabola
  std::array<double, 21> pairs{};
  double readings = 0;
  for (const Switch& s : switches) {
    for (const Parabola& p : {s.before, s.after}) {
      const auto off = [&](std::size_t i) {
        const double off_m = record.readings[i].position_m - p.position_at(static_cast<double>(i), record.period_s);
        return off_m / std::max(p.residual_m, rounding_m(record));
      };
      readings += static_cast<double>(p.last - p.first);
      for (std::size_t apart = 1; apart < products.size(); ++apart) {
        for (std::size_t i = p.first; i + apart < p.last; ++i) {
          products[apart] += off(i) * off(i + apart);
          ++pairs[apart];
        }
      }
    }
  }
  // The three numbers of a parabola follow the readings, and leave them this much less by chance.
  const double fitted = 3 * 2 * static_cast<double>(switches.size()) / readings;
  for (std::size_t apart = 1; apart < products.size() && pairs[apart] > 0; ++apart) {
    const double five_errors = 5 / std::sqrt(pairs[apart]);
    if (std::abs(products[apart] / pairs[apart]) > fitted + std::max(0.3, five_errors)) return false;
  }
  return true;
}

// A mass under constant force and friction draws parabolas, but for what friction changes on the way.
void require_rigid(const std::vector<Switch>& switches, const Record& record, const std::vector<Stretch>& stretches) {
  std::vector<double> residuals_m, shares;
  for (const Switch& s : switches) {
    const double half_s = static_cast<double>(s.readings) / 2 * record.period_s;
    residuals_m.push_back(std::max(s.before.residual_m, s.after.residual_m));
    shares.push_back(residuals_m.back() / (std::abs(s.change_m_s2()) / 2 * half_s * half_s));
  }
  const double residual_m = median(residuals_m);
  if (residual_m < 10 * record.resolution_m || median(shares) < 0.01) return;
  if (are_off_by_chance(switches, record)) return;
  const std::optional<Swing> swing = swing_of(record, switches_in_motion(record, stretches));
  throw InputError{fmt::format(
      "under a constant force the positions are {:.2g} m off a parabola, so that the axis is no single mass: a load "
      "{}; "
      "for a load behind a motor with the encoder describe it roughly in a table [plant.load], and identify again",
      residual_m,
      swing ? fmt::format("swings on a spring, {:.3g} times a second", swing->rate_rad_s / (2 * std::numbers::pi))
            : std::string{"swings on a spring or has play"})};
}

}  // namespace

Identification evaluate(const Record& record, const Margins& margins, Mechanism mechanism) {
  require_readable(record);
  const std::vector<Stretch> stretches = stretches_of(record);
  if (mechanism == Mechanism::load_on_spring) return evaluate_sprung(record, stretches, margins);
  Look look;
  std::vector<Switch> switches = switches_in(record, stretches, look);
  if (switches.empty())
    throw InputError{
        "the record has no switch from one constant force to another during a motion, so that nothing tells the mass: "
        "record an experiment, or give the axis more travel and speed, or a finer encoder"};
  Identification found;
  found.duration_s = static_cast<double>(record.readings.size()) * record.period_s;
  // What the first looks say of latency and lag tells the next from where on a parabola is one.
  for (int i = 0; i < 2; ++i) {
    look.uneven = are_off_by_chance(switches, record);
    found.latency = latency_of(switches, record);
    const int latency = found.latency.fewest_periods;
    const double lag_s = std::max(found.latency.delay_s - latency * record.period_s, 0.0);
    look.settling = static_cast<std::size_t>(latency + 1 + std::ceil(6 * lag_s / record.period_s));
    const std::vector<Switch> again = switches_in(record, stretches, look);
    if (!again.empty()) switches = again;
  }
  found.latency = latency_of(switches, record);
  found.mass = mass_of(switches, record);
  require_rigid(switches, record, stretches);
  require_causal(found.latency, record.period_s);
  require_enough(switches.size(), found.mass.switches);
  const double m = found.mass.mass_kg;
  const std::vector<BreakAway> broken = break_aways_in(record, found.latency, m);
  if (broken.empty())
    throw InputError{
        "the record has no slow ramp of force that ends a rest, so that nothing tells the friction at rest: "
        "record an experiment, with readings that differ by no more than a count where the axis rests"};
  found.presliding_N_per_m = presliding_stiffness_N_per_m(record, broken, found.latency);
  std::vector<double> at_rest_N;
  at_rest_N.reserve(broken.size());
  for (const BreakAway& one : broken) at_rest_N.push_back(one.seen.friction_N.most);
  Friction friction{record, m, 0.005, std::ranges::min(at_rest_N), look, {}};
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
  require_sure_mass(found);
  return found;
}

}  // namespace breakaway::evaluation
