#include "breakaway/config/new_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/cia402/drive_config.hpp"
#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/law/kick_judge.hpp"

namespace breakaway::config {
namespace {

constexpr std::string_view name = "the new file";
constexpr std::uint32_t bit_rate = 1'000'000;
constexpr double most_speed_m_s = 1e12;  // that a file may state

// What the file is given beside what is known.
struct Chosen {
  double tolerance_m, settle_tolerance_m, approach_speed_m_s, speed_limit_m_s, duration_s, travel_m;
};

// The range is that of the key it is written to, or of what follows from it.
struct NumberRange {
  double KnownAxis::*number;
  std::string_view what, unit;
  double least, most;
};

constexpr std::array number_ranges{
    NumberRange{&KnownAxis::mass_kg, "the mass", "kg", 1e-9, 1e9},
    NumberRange{&KnownAxis::friction_lower_N, "the lower bound of friction", "N", 1e-9, 1e9},
    NumberRange{&KnownAxis::friction_upper_N, "the upper bound of friction", "N", 1e-9, 1e9},
    NumberRange{&KnownAxis::encoder_resolution_m, "the count of the encoder", "m", 1e-12, 1},
    NumberRange{&KnownAxis::rate_Hz, "the rate", "Hz", 1e-3, 1e6},
    NumberRange{&KnownAxis::max_force_N, "the force", "N", 1e-9, 1e9},
    NumberRange{&KnownAxis::longest_move_m, "the longest move", "m", 1e-9, 1e6},
};

void require_in_range(const NumberRange& r, double value) {
  if (!(std::isfinite(value) && value > 0))
    throw InputError{fmt::format("{} is {:g}, which is not a finite number above 0", r.what, value)};
  if (value < r.least || value > r.most)
    throw InputError{fmt::format("{} is {:g} {}, outside {:g} to {:g} {}: check its unit", r.what, value, r.unit,
                                 r.least, r.most, r.unit)};
}

// Of the encoder's zero, either way.
double travel_m(const KnownAxis& known) { return rounded_up(1.25 * known.longest_move_m, 2); }

// That an approach may go beyond its target is within the travel as well.
void require_counted(const KnownAxis& known, double travel_m) {
  const double range_m = 2 * travel_m, counted_m = 0x1p31 * known.encoder_resolution_m;
  if (range_m < counted_m) return;
  throw InputError{fmt::format(
      "the longest move, {:g} m, needs a travel of {:g} m, and 32 bits count less than {:.4g} m with the encoder's "
      "{:g} m a count; let the drive scale its position to a count of {:.2g} m at least, or give a shorter move",
      known.longest_move_m, range_m, counted_m, known.encoder_resolution_m, rounded_up(1.01 * range_m / 0x1p31, 2))};
}

void require_seen_to_move(const KnownAxis& known, double travel_m, double farthest_m) {
  const double range_m = 2 * travel_m;
  if (range_m <= farthest_m) return;
  throw InputError{fmt::format(
      "the longest move, {:g} m, needs a travel of {:g} m, and over more than {:g} m a float does not tell so slow an "
      "axis from one that sticks; give a shorter move, a coarser encoder or a stronger drive",
      known.longest_move_m, range_m, rounded_down(farthest_m, 3))};
}

bool can_be_told(hal::Duration period) { return cia402::interpolation_period(period).has_value(); }

hal::Duration period_of(double rate_Hz) { return hal::Duration{std::llround(1e9 / rate_Hz)}; }

// The next rate of few digits, below or above, whose period drives can be told, and which the bus carries; 0: there is
// none, which is never so below one of 10 Hz and more.
double next_rate_Hz(double rate_Hz, bool above, double most_Hz) {
  constexpr std::array digits{1.0, 1.25, 1.5625, 2.0, 2.5, 3.125, 4.0, 5.0, 6.25, 8.0};
  const auto works = [&](double candidate_Hz) {
    return candidate_Hz >= 1 && candidate_Hz <= most_Hz && can_be_told(period_of(candidate_Hz)) &&
           (above ? candidate_Hz > rate_Hz : candidate_Hz < rate_Hz);
  };
  double best_Hz = 0;
  for (double decade = 1; decade <= 1e5; decade *= 10) {
    for (const double digit : digits) {
      const double candidate_Hz = digit * decade;
      const bool nearer = best_Hz == 0 || (above ? candidate_Hz < best_Hz : candidate_Hz > best_Hz);
      if (works(candidate_Hz) && nearer) best_Hz = candidate_Hz;
    }
  }
  return best_Hz;
}

void require_rate(const KnownAxis& known) {
  constexpr double least_Hz = 10;  // with the heartbeats of every other period that a drive waits 0.25 s for
  if (known.rate_Hz < least_Hz)
    throw InputError{
        fmt::format("the rate is {:g} Hz, and a file begins with {:g} Hz at least; raise it", known.rate_Hz, least_Hz)};
  const auto budget = canopen::bus_budget(1, std::chrono::seconds{1}, bit_rate);
  const double most_Hz = 1e9 / static_cast<double>(budget.least_period.count());
  if (known.rate_Hz > most_Hz)
    throw InputError{fmt::format("the rate, {:g} Hz, does not fit a [bus] of {} bit/s; take {:g} Hz or less",
                                 known.rate_Hz, bit_rate, next_rate_Hz(most_Hz, false, most_Hz))};
  if (can_be_told(period_of(known.rate_Hz))) return;
  const double above_Hz = next_rate_Hz(known.rate_Hz, true, most_Hz);
  throw InputError{fmt::format(
      "the rate, {:g} Hz, makes a period that drives cannot be told (60C2h: 1 to 255 times 1 s, 0.1 s, ... or 1 us); "
      "take {:g}{} Hz",
      known.rate_Hz, next_rate_Hz(known.rate_Hz, false, most_Hz),
      above_Hz > 0 ? fmt::format(" or {:g}", above_Hz) : "")};
}

void require_strong_enough(const KnownAxis& known) {
  if (known.max_force_N > known.friction_upper_N) return;
  const auto [force, friction] = compared(known.max_force_N, known.friction_upper_N);
  throw InputError{
      fmt::format("the force, {} N, does not exceed the upper bound of friction, {} N, so that "
                  "nothing would move; take a stronger drive or a gear",
                  force, friction)};
}

void require_ordered(const KnownAxis& known) {
  if (known.friction_lower_N < known.friction_upper_N) return;
  const auto [lower, upper] = compared(known.friction_lower_N, known.friction_upper_N);
  throw InputError{
      fmt::format("the bounds of friction are {} and {} N; the lower one must be below the upper", lower, upper)};
}

// The drive's force as it is written, of so many digits, and the force of a newton metre of its motor: torques are
// stated in thousandths, which a force below 1 N would lose digits to.
struct WrittenForce {
  double force_N, torque_Nm, per_torque = 1;
};

WrittenForce written(double force_N) {
  constexpr int digits = 4;
  WrittenForce w{rounded_down(force_N, digits), 0};
  constexpr double most_Nm = 1e6;
  while (w.force_N < w.per_torque) w.per_torque /= 10;
  while (w.force_N > most_Nm * w.per_torque) w.per_torque *= 10;
  w.torque_Nm = rounded_down(w.force_N / w.per_torque, digits);
  return w;
}

// The greatest speed of the longest move, half of it with all force and half braking.
double greatest_speed_m_s(const KnownAxis& known) {
  return std::sqrt(known.longest_move_m * (known.max_force_N - known.friction_upper_N) / known.mass_kg);
}

void require_allowed(const KnownAxis& known, double speed_m_s) {
  if (2 * speed_m_s < most_speed_m_s) return;
  throw InputError{
      fmt::format("the force, {:g} N, would give the mass, {:g} kg, a speed of {:.2g} m/s; check their units",
                  known.max_force_N, known.mass_kg, speed_m_s)};
}

// That an approach must be allowed, however little of it a short move or a weak drive lets the axis reach.
double approach_speed_m_s(const KnownAxis& known, const Node& node) {
  const double reached_m_s = greatest_speed_m_s(known);
  const design::BrakedClass axes = braked_class(node, node.axes.front());
  const auto design = design::design_braked_kicks<float>(axes);
  if (!design.possible()) return rounded_up(reached_m_s, 2);
  const double least_m_s = design::least_approach_speed_m_s(axes, design);
  require_allowed(known, std::max({reached_m_s, least_m_s, design.peak_speed_m_s}));
  return rounded_up(std::max(reached_m_s, least_m_s), 2);
}

std::string file_text(const KnownAxis& known, const Chosen& chosen) {
  const double omega = 20;  // 1/s of k1; the dampings are 0.8 and 1.5 of the critical one
  const WrittenForce force = written(known.max_force_N);
  const double k1 = known.mass_kg * omega * omega, critical = 2 * known.mass_kg * omega;
  return fmt::format(
      R"(# An axis with dry friction, as `breakaway new` wrote it. SI units; the unit stands in each name. Try it with
#   breakaway design FILE                         what is certified, and what limits it
#   breakaway simulate FILE --report axis.html    one run, with pictures
#   breakaway study FILE                          104 friction laws between the bounds
title = "A new axis"

[plant]
mass_kg = {mass} # everything that moves, reflected to the axis
position_m = {start} # the simulation begins here, the longest move away from the target 0

[friction] # of the whole axis, at every place, speed, temperature and age: the certificate holds between these
lower_N = {lower}
upper_N = {upper}

[friction.law] # of the simulated axis: high at rest, low in motion
kind = "stribeck"
velocity_m_s = 0.05

[controller]
k1_N_per_m = {k1} # the gains are those of the coast "pd" alone
k21_Ns_per_m = {k21}
k22_Ns_per_m = {k22}
coast = "brake" # after each kick a force weaker than the least friction: no kick goes beyond the target
max_force_N = {force}
max_approach_speed_m_s = {speed} # lower it where the machine asks for it
position_tolerance_m = {tolerance} # the least that is certified, rounded up

[uncertainty] # how far what is told may be off, relative, either way; what is measured better may be less
mass = 0.02
force_gain = 0.02
current_loop_time_constant = 0.2
# jitter_s = {frame} # s; the longest frame of others, such as a drive's heartbeat, holds SYNC up by so much now and then

[loop]
period_s = {period}

[drive] # of its data sheet. Here one per mille of the rated torque makes a thousandth of the force
rated_torque_Nm = {torque}
rated_current_A = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = {per_torque} # 1 for a linear motor; 1 / radius for a drum or a pulley; 2 pi / lead for a screw
encoder_resolution_m = {count}
current_loop_time_constant_s = {lag}

[bus]
bit_rate = {bit_rate}

[limits]
position_m = {travel} # from the encoder's zero, either way
speed_m_s = {speed_limit}

[run]
duration_s = {duration}
settle_tolerance_m = {settle} # the tolerance and half a count
settle_time_s = 0.2
)",
      fmt::arg("mass", known.mass_kg), fmt::arg("start", -known.longest_move_m),
      fmt::arg("lower", known.friction_lower_N), fmt::arg("upper", known.friction_upper_N), fmt::arg("k1", k1),
      fmt::arg("k21", 0.8 * critical), fmt::arg("k22", 1.5 * critical), fmt::arg("force", force.force_N),
      fmt::arg("torque", force.torque_Nm), fmt::arg("per_torque", force.per_torque), fmt::arg("bit_rate", bit_rate),
      fmt::arg("speed", chosen.approach_speed_m_s), fmt::arg("tolerance", chosen.tolerance_m),
      fmt::arg("period", 1 / known.rate_Hz), fmt::arg("count", known.encoder_resolution_m),
      fmt::arg("lag", std::min(2e-4, 0.2 / known.rate_Hz)),
      fmt::arg("frame", static_cast<double>(hal::worst_case_wire_bits(8)) / bit_rate),
      fmt::arg("travel", chosen.travel_m), fmt::arg("speed_limit", chosen.speed_limit_m_s),
      fmt::arg("duration", chosen.duration_s), fmt::arg("settle", chosen.settle_tolerance_m));
}

NewNode written(const KnownAxis& known, const Chosen& chosen) {
  NewNode made{file_text(known, chosen), {}, {}};
  made.node = parse_node(made.text, std::string{name});
  return made;
}

NewNode examined(const KnownAxis& known, const Chosen& chosen) {
  NewNode made = written(known, chosen);
  made.report = examine(made.node).front();
  return made;
}

// Before it is known how much travel the axis needs.
NewNode designed(const KnownAxis& known, const Chosen& chosen) {
  NewNode made = written(known, chosen);
  made.report = design::design_axis(axis_design(made.node, made.node.axes.front()));
  return made;
}

void require_longer_move(const KnownAxis& known, const design::DesignReport& report) {
  if (!report.braked || !(report.braked->least_tolerance_m > known.longest_move_m)) return;
  throw InputError{fmt::format(
      "the longest move, {:g} m, is shorter than what can be certified as on the target with these numbers, {:g} m; "
      "give a longer move, a finer encoder or a higher rate",
      known.longest_move_m, rounded_up(report.braked->least_tolerance_m, 4))};
}

// The least of two digits that the law comes to by as many kicks as it has. Where friction may be many times its least,
// the last kicks before the least tolerance lead on by so little that they are too many.
double promised_tolerance_m(const KnownAxis& known, const NewNode& made) {
  const design::BrakedClass axes = braked_class(made.node, made.node.axes.front());
  const auto design = design::design_braked_kicks<float>(axes);
  const double from_m = design::kicks_begin_m(design);
  double tolerance_m = rounded_up(design.least_tolerance_m, 2);
  const auto kicks_do = [&] {
    const int kicks = design::most_kicks(axes, design, from_m, tolerance_m);
    return tolerance_m >= from_m || (kicks > 0 && kicks <= law::KickJudge<float>::most_kicks);
  };
  while (!kicks_do()) {
    const double wider_m = rounded_up(1.05 * tolerance_m, 2);
    if (wider_m >= known.longest_move_m) break;
    tolerance_m = wider_m;
  }
  return tolerance_m;
}

// There is no file yet to look into.
void require_certified(const NewNode& made) {
  if (made.report.certified) return;
  throw InputError{"no accuracy can be certified with these numbers: " + made.report.reasons.front()};
}

}  // namespace

void require_possible_so_far(const KnownAxis& known) {
  const auto said = [&](auto... numbers) { return ((known.*numbers != 0) && ...); };
  for (const NumberRange& range : number_ranges)
    if (said(range.number)) require_in_range(range, known.*range.number);
  if (said(&KnownAxis::friction_lower_N, &KnownAxis::friction_upper_N)) require_ordered(known);
  if (said(&KnownAxis::friction_upper_N, &KnownAxis::max_force_N)) require_strong_enough(known);
  if (said(&KnownAxis::encoder_resolution_m, &KnownAxis::longest_move_m)) require_counted(known, travel_m(known));
  if (said(&KnownAxis::rate_Hz)) require_rate(known);
}

NewNode new_node(const KnownAxis& known) {
  for (const NumberRange& range : number_ranges) require_in_range(range, known.*range.number);
  require_possible_so_far(known);
  const double half_count_m = known.encoder_resolution_m / 2;
  // What the design says of a tolerance that is surely wide enough is enough to choose all numbers.
  const double wide_m = known.longest_move_m;
  const double counted_m = 0.49 * 0x1p31 * known.encoder_resolution_m;
  const double reached_m_s = rounded_up(greatest_speed_m_s(known), 2);
  Chosen chosen{wide_m, wide_m + known.encoder_resolution_m, reached_m_s, most_speed_m_s, 1, std::min(1e9, counted_m)};
  chosen.approach_speed_m_s = approach_speed_m_s(known, parse_node(file_text(known, chosen), std::string{name}));
  const NewNode first = designed(known, chosen);
  require_longer_move(known, first.report);
  require_certified(first);
  const design::BrakedPromise& wide = *first.report.braked;
  chosen.travel_m = std::max(travel_m(known), rounded_up(known.longest_move_m + wide.approach_beyond_m, 2));
  require_counted(known, chosen.travel_m);
  require_seen_to_move(known, chosen.travel_m, wide.farthest_m);
  chosen.tolerance_m = promised_tolerance_m(known, first);
  chosen.settle_tolerance_m = rounded_up(chosen.tolerance_m + half_count_m, 3);
  chosen.speed_limit_m_s = rounded_up(2 * std::max(chosen.approach_speed_m_s, wide.kick_peak_m_s), 2);
  chosen.duration_s = 60;
  const NewNode second = examined(known, chosen);
  require_certified(second);
  chosen.duration_s = rounded_up(1 + 10 * known.longest_move_m / reached_m_s + second.report.braked->kicks_s, 2);
  return examined(known, chosen);
}

}  // namespace breakaway::config
