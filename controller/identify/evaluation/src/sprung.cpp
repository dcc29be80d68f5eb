#include "sprung.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>

#include "bends.hpp"
#include "breakaway/input/input_error.hpp"
#include "switches.hpp"
#include "totals.hpp"

namespace breakaway::evaluation {
namespace {

constexpr double most_uncertain = 0.1;  // of a mass; no coast "work" is certified beyond

struct SeenSwitch {
  SwitchInMotion one;
  SwingFit fit;
  double rate_rad_s;
};

// The rate that suits one switch best, near that of all.
double rate_of(const Record& record, const SwitchInMotion& one, Swing swing) {
  const auto cost = [&](double rate) {
    swing.rate_rad_s = rate;
    const auto fit = fit_swing(record, one, swing);
    return fit ? fit->residual_m : INFINITY;
  };
  constexpr double golden = 0.6180339887498949;
  double low = 0.95 * swing.rate_rad_s, high = 1.05 * swing.rate_rad_s;
  double a = high - golden * (high - low), b = low + golden * (high - low), at_a = cost(a), at_b = cost(b);
  for (int i = 0; i < 24; ++i) {
    if (at_a < at_b) {
      high = b, b = a, at_b = at_a;
      a = high - golden * (high - low), at_a = cost(a);
    } else {
      low = a, a = b, at_a = at_b;
      b = low + golden * (high - low), at_b = cost(b);
    }
  }
  return (low + high) / 2;
}

// Those of the greatest steps in which both slide throughout and the fit leaves little more than counts.
std::vector<SeenSwitch> seen_switches(const Record& record, const std::vector<SwitchInMotion>& switches,
                                      const Swing& swing) {
  double most_N = 0;
  for (const SwitchInMotion& one : switches) most_N = std::max(most_N, std::abs(one.after_N - one.before_N));
  std::vector<SeenSwitch> seen;
  for (const SwitchInMotion& one : switches) {
    const double step_N = std::abs(one.after_N - one.before_N);
    if (step_N < 0.4 * most_N) continue;
    Swing own = swing;
    own.rate_rad_s = rate_of(record, one, swing);
    const auto fit = fit_swing(record, one, own);
    if (!fit || !both_slide(*fit, one, own, record.period_s)) continue;
    const double swing_m = fit->swing_m_per_N * step_N;
    if (fit->residual_m > std::max(1.5 * record.resolution_m, 0.1 * swing_m)) continue;
    seen.push_back({one, *fit, own.rate_rad_s});
  }
  return seen;
}

template <class Value>
std::vector<double> values_of(const std::vector<SeenSwitch>& seen, Value value) {
  std::vector<double> values;
  values.reserve(seen.size());
  for (const SeenSwitch& s : seen) values.push_back(value(s));
  return values;
}

// The greatest share by which a value is off this one.
double spread_about(const std::vector<double>& values, double middle) {
  const Interval range = range_of(values);
  return std::max(range.most - middle, middle - range.least) / middle;
}

void enter_masses(Identification& found, SpringEstimate& spring, const std::vector<SeenSwitch>& seen,
                  const Margins& margins) {
  const auto motor_kg =
      values_of(seen, [](const SeenSwitch& s) { return s.fit.mass_kg() / (1 + s.fit.mass_ratio(s.rate_rad_s)); });
  const auto load_kg = values_of(seen, [](const SeenSwitch& s) {
    const double rho = s.fit.mass_ratio(s.rate_rad_s);
    return s.fit.mass_kg() * rho / (1 + rho);
  });
  spring.motor_kg = median(motor_kg), spring.load_kg = median(load_kg);
  const auto both_kg = values_of(seen, [](const SeenSwitch& s) { return s.fit.mass_kg(); });
  found.mass = {.mass_kg = spring.motor_kg + spring.load_kg, .seen_kg = range_of(both_kg), .switches = seen.size()};
  const double apart = std::max(spread_about(motor_kg, spring.motor_kg), spread_about(load_kg, spring.load_kg));
  found.mass_uncertainty = std::max(margins.masses, 2 * apart);
}

void enter_spring(SpringEstimate& spring, const std::vector<SeenSwitch>& seen, const Swing& swing,
                  const Margins& margins) {
  spring.switches = seen.size();
  spring.resonance_Hz =
      range_of(values_of(seen, [](const SeenSwitch& s) { return s.rate_rad_s / (2 * std::numbers::pi); }));
  spring.stiffness_seen_N_per_m =
      range_of(values_of(seen, [](const SeenSwitch& s) { return s.fit.stiffness_N_per_m(s.rate_rad_s); }));
  spring.stiffness_N_per_m = spring.stiffness_seen_N_per_m.least * (1 - margins.stiffness);
  const double reduced_kg = spring.motor_kg * spring.load_kg / (spring.motor_kg + spring.load_kg);
  const bool damped = swing.decay_1_s > 0.002 * swing.rate_rad_s;
  spring.damping_Ns_per_m = damped ? 2 * reduced_kg * swing.decay_1_s * (1 - margins.damping) : 0;
}

// Of both together, half way before and half way after a switch.
void add_friction(Identification& found, const SeenSwitch& seen, const Record& record) {
  const SwitchInMotion& s = seen.one;
  const double T = record.period_s, mass_kg = found.mass.mass_kg;
  const auto add = [&](std::size_t at, double force_N, double step_N) {
    const double t = (static_cast<double>(at) - static_cast<double>(s.at)) * T;
    const auto& c = seen.fit.cubic;
    const double a_m_s2 = 2 * c[2] + 6 * c[3] * t + step_N * seen.fit.per_kg;
    const double v_m_s = c[1] + (2 * c[2] + 3 * c[3] * t + step_N * seen.fit.per_kg) * t;
    const double friction_N = s.direction * (force_N - mass_kg * a_m_s2);
    const double error_N = 0.005 * (std::abs(force_N) + mass_kg * std::abs(a_m_s2));
    found.friction.push_back({.position_m = record.readings[at].position_m,
                              .speed_m_s = v_m_s,
                              .direction = s.direction,
                              .friction_N = {friction_N - error_N, friction_N + error_N},
                              .motion = 0});
  };
  add((s.first + s.at) / 2, s.before_N, 0);
  add((s.at + s.last) / 2, s.after_N, s.after_N - s.before_N);
}

// What broke both away, and the sliding that followed it, in the order of time.
void enter_friction(Identification& found, const std::vector<SeenSwitch>& seen,
                    const std::vector<SprungBreakAway>& broken, const Record& record) {
  std::size_t next = 0;
  const auto add_broken = [&](std::size_t before) {
    for (; next < broken.size() && broken[next].at <= before; ++next)
      found.friction.push_back({.position_m = broken[next].position_m,
                                .speed_m_s = 0,
                                .direction = broken[next].direction,
                                .friction_N = {0.99 * broken[next].both_N, 1.01 * broken[next].both_N},
                                .motion = 0});
  };
  for (const SeenSwitch& one : seen) {
    add_broken(one.one.first);
    add_friction(found, one, record);
  }
  add_broken(record.readings.size());
}

// The load's share is what broke both away less what turned the motor in the bend before. Friction that falls as the
// axis slides is taken to fall on both sides by the same share.
void enter_sides(const Identification& found, SpringEstimate& spring, const std::vector<Bend>& bends,
                 const std::vector<SprungBreakAway>& broken, const Margins& margins) {
  std::vector<double> motor_N, load_N, both_N;
  for (const SprungBreakAway& one : broken) {
    const auto after = std::ranges::upper_bound(bends, one.at, {}, &Bend::at);
    if (after == bends.begin()) continue;
    const Bend& bend = *std::prev(after);
    const auto same = std::ranges::find_if(
        broken, [&](const SprungBreakAway& other) { return other.at > bend.at && other.at < one.at; });
    if (same != broken.end()) continue;
    motor_N.push_back(bend.motor_N), load_N.push_back(one.both_N - bend.motor_N), both_N.push_back(one.both_N);
  }
  spring.bends = motor_N.size();
  if (spring.bends < least_bends)
    throw InputError{fmt::format(
        "the spring was bent {} times and {} are needed, so that nothing tells how motor and load share the friction: "
        "record the experiment of a file with [plant.load], or give it more travel, time or a finer encoder",
        spring.bends, least_bends)};
  const double falls = std::min(found.friction_seen_N.least / range_of(both_N).least, 1.0);
  const auto bounds = [&](const std::vector<double>& seen_N) {
    const Interval range = range_of(seen_N);
    return Interval{range.least * falls * (1 - margins.side), range.most * (1 + margins.side)};
  };
  spring.motor_N = bounds(motor_N), spring.load_N = bounds(load_N);
  if (spring.motor_N.least > 0 && spring.load_N.least > 0) return;
  throw InputError{
      "friction of motor or load comes out at 0 or less, so that something else pushes the axis, or the joint has "
      "play: "
      "balance a weight, and take the play out"};
}

void require_sure_masses(const Identification& found) {
  if (found.mass_uncertainty <= most_uncertain) return;
  throw InputError{fmt::format(
      "the switches of the force differ by so much that motor and load are sure to within {:.2g} only, and a "
      "certificate "
      "needs a tenth: the swing is hardly to be seen in counts, or the joint has play; give the axis more force, or a "
      "finer encoder",
      found.mass_uncertainty)};
}

}  // namespace

Identification evaluate_sprung(const Record& record, const std::vector<Stretch>& stretches, const Margins& margins) {
  const std::vector<SwitchInMotion> switches = switches_in_motion(record, stretches);
  const std::optional<Swing> swing = swing_of(record, switches);
  if (!swing)
    throw InputError{
        "the record shows no swing of a load about the switches of the force: the joint is stiffer or the load lighter "
        "than count and period let one see, so leave [plant.load] out and identify one mass; or the axis moved too "
        "little: give it more travel or force"};
  const std::vector<SeenSwitch> seen = seen_switches(record, switches, *swing);
  if (seen.size() < least_switches)
    throw InputError{fmt::format(
        "of {} switches of the force in motion {} suit a load on a spring, and {} are needed: the joint may have play, "
        "or "
        "motor or load stopped on the way; give the axis more travel or force",
        switches.size(), seen.size(), least_switches)};
  Identification found;
  found.duration_s = static_cast<double>(record.readings.size()) * record.period_s;
  const auto periods = static_cast<int>(std::lround(swing->delay_s / record.period_s));
  found.latency = {.periods = periods,
                   .fewest_periods = periods,
                   .most_periods = periods,
                   .delay_s = swing->delay_s,
                   .delay_seen_s = {swing->delay_s, swing->delay_s}};
  SpringEstimate spring;
  enter_masses(found, spring, seen, margins);
  enter_spring(spring, seen, *swing, margins);
  require_sure_masses(found);
  const std::vector<SprungBreakAway> broken = sprung_break_aways_in(record, *swing, found.mass.mass_kg);
  enter_friction(found, seen, broken, record);
  number_motions(found);
  found.margins = margins;
  sum_up(found, margins);
  require_friction(found);
  const Interval& stiffness = spring.stiffness_seen_N_per_m;
  const double middle_N_per_m = (stiffness.least + stiffness.most) / 2;
  const std::vector<Bend> bends = bends_in(record, *swing, middle_N_per_m);
  require_tight(bends, middle_N_per_m, record.resolution_m);
  enter_sides(found, spring, bends, broken, margins);
  found.spring = spring;
  return found;
}

}  // namespace breakaway::evaluation
