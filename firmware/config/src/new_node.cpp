#include "breakaway/config/new_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {
namespace {

constexpr std::string_view name = "the new file";

// What the file is given beside what is known.
struct Chosen {
  double tolerance_m, settle_tolerance_m, approach_speed_m_s, speed_limit_m_s, duration_s;
};

// To so many significant digits. A value that has no more stays, in spite of the roundings here.
double rounded(double value, int digits, double (*to_whole)(double), double slack) {
  const double unit = std::pow(10, std::floor(std::log10(value)) + 1 - digits);
  return std::stod(fmt::format("{:.{}e}", to_whole(value / unit * slack) * unit, digits - 1));
}
double rounded_up(double value, int digits) { return rounded(value, digits, std::ceil, 1 - 1e-9); }
double rounded_down(double value, int digits) { return rounded(value, digits, std::floor, 1 + 1e-9); }

void require_number(double value, std::string_view what) {
  if (std::isfinite(value) && value > 0) return;
  throw InputError{fmt::format("{} is {:g}, which is not a finite number above 0", what, value)};
}

void require_possible(const KnownAxis& known) {
  require_number(known.mass_kg, "the mass");
  require_number(known.friction_lower_N, "the lower bound of friction");
  require_number(known.friction_upper_N, "the upper bound of friction");
  require_number(known.encoder_resolution_m, "the count of the encoder");
  require_number(known.rate_Hz, "the rate");
  require_number(known.max_force_N, "the force");
  require_number(known.longest_move_m, "the longest move");
  if (known.friction_lower_N >= known.friction_upper_N)
    throw InputError{fmt::format("the bounds of friction are {:g} and {:g} N; the lower one must be below the upper",
                                 known.friction_lower_N, known.friction_upper_N)};
  if (known.max_force_N <= known.friction_upper_N)
    throw InputError{
        fmt::format("the force, {:g} N, does not exceed the upper bound of friction, {:g} N, so that "
                    "nothing would move; take a stronger drive or a gear",
                    known.max_force_N, known.friction_upper_N)};
}

// The greatest speed of the longest move, half of it with all force and half braking.
double greatest_speed_m_s(const KnownAxis& known) {
  return std::sqrt(known.longest_move_m * (known.max_force_N - known.friction_upper_N) / known.mass_kg);
}

std::string file_text(const KnownAxis& known, const Chosen& chosen) {
  const double omega = 20;  // 1/s of k1; the dampings are 0.8 and 1.5 of the critical one
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

[loop]
period_s = {period}

[drive] # of its data sheet. Here one per mille of the rated torque makes a thousandth of the force
rated_torque_Nm = {force}
rated_current_A = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = 1 # 1 for a linear motor; 1 / radius for a drum or a pulley; 2 pi / lead for a screw
encoder_resolution_m = {count}
current_loop_time_constant_s = {lag}

[bus]
bit_rate = 1_000_000

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
      fmt::arg("k21", 0.8 * critical), fmt::arg("k22", 1.5 * critical),
      fmt::arg("force", rounded_down(known.max_force_N, 4)), fmt::arg("speed", chosen.approach_speed_m_s),
      fmt::arg("tolerance", chosen.tolerance_m), fmt::arg("period", 1 / known.rate_Hz),
      fmt::arg("count", known.encoder_resolution_m), fmt::arg("lag", std::min(2e-4, 0.2 / known.rate_Hz)),
      fmt::arg("travel", rounded_up(1.25 * known.longest_move_m, 2)), fmt::arg("speed_limit", chosen.speed_limit_m_s),
      fmt::arg("duration", chosen.duration_s), fmt::arg("settle", chosen.settle_tolerance_m));
}

NewNode examined(const KnownAxis& known, const Chosen& chosen) {
  NewNode made{file_text(known, chosen), {}, {}};
  made.node = parse_node(made.text, std::string{name});
  made.report = examine(made.node).front();
  return made;
}

}  // namespace

NewNode new_node(const KnownAxis& known) {
  require_possible(known);
  const double speed_m_s = rounded_up(greatest_speed_m_s(known), 2), half_count_m = known.encoder_resolution_m / 2;
  // What the design says of a tolerance that is surely wide enough is enough to choose all numbers.
  const double wide_m = known.longest_move_m;
  Chosen chosen{wide_m, wide_m + known.encoder_resolution_m, speed_m_s, 1e6, 1};
  const NewNode first = examined(known, chosen);
  require_certified(first.node, {first.report});
  const design::BrakedPromise& wide = *first.report.braked;
  chosen.tolerance_m = rounded_up(wide.least_tolerance_m, 2);
  chosen.settle_tolerance_m = rounded_up(chosen.tolerance_m + half_count_m, 3);
  chosen.speed_limit_m_s = rounded_up(2 * std::max(speed_m_s, wide.peak_speed_m_s), 2);
  chosen.duration_s = 60;
  const NewNode second = examined(known, chosen);
  require_certified(second.node, {second.report});
  chosen.duration_s = rounded_up(1 + 10 * known.longest_move_m / speed_m_s + second.report.braked->kicks_s, 2);
  return examined(known, chosen);
}

}  // namespace breakaway::config
