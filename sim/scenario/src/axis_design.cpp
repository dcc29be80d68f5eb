#include "breakaway/scenario/axis_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/axis_config.hpp"

namespace breakaway::scenario {
namespace {

// The accuracy that the file asks for. The ideal law reaches any, so there it may be left out.
double tolerance_m(const Scenario& s) {
  if (s.run && s.run->settle_tolerance_m > 0) return s.run->settle_tolerance_m;
  if (s.controller.position_tolerance_m > 0) return s.controller.position_tolerance_m;
  if (s.ideal()) return std::numeric_limits<double>::min();
  throw InputError{"[run] settle_tolerance_m is missing: say which accuracy the axis shall reach"};
}

// What the controller may ask for and the drive can give.
double max_force_N(const Scenario& s) {
  const double asked_N = std::min(s.controller.max_force_N, std::numeric_limits<double>::max());
  return s.drive ? std::min(asked_N, drive_force_N(*s.drive)) : asked_N;
}

}  // namespace

void require_fitting_bus(const Scenario& s) {
  if (!s.loop || !s.bus) return;
  const hal::Duration period = nanoseconds(s.loop->period_s);
  if (canopen::check_bus_budget(1, period, s.bus->bit_rate) == canopen::BusFit::fits) return;
  const auto budget = canopen::bus_budget(1, period, s.bus->bit_rate);
  throw InputError(fmt::format(
      "{}: 1 axis at [loop] period_s = {} does not fit a [bus] of {} bit/s: a period needs {} us on the bus and has {} "
      "us; "
      "choose a period_s of at least {:.6f}",
      s.file, s.loop->period_s, s.bus->bit_rate, budget.needed_us, budget.available_us,
      hal::seconds(budget.least_period)));
}

design::AxisDesign axis_design(const Scenario& s) {
  if (!s.controller.impulsive) {
    throw InputError{"[controller] kind is \"pid\"; design checks the impulsive law only"};
  }
  require_fitting_bus(s);
  const auto p = axis_parameters<double>(s);
  return {.mass_kg = p.mass_kg,
          .stiffness_N_per_m = p.stiffness_N_per_m,
          .approach_damping_Ns_per_m = p.approach_damping_Ns_per_m,
          .kick_damping_Ns_per_m = p.kick_damping_Ns_per_m,
          .friction = {p.friction.lower_N, p.friction.upper_N},
          .smooth_friction_slope_Ns_per_m = s.friction.smooth_slope_Ns_per_m,
          .max_force_N = max_force_N(s),
          .period_s = p.period_s,
          .encoder_resolution_m = p.encoder_resolution_m,
          .latency_ticks = p.latency_periods,
          .position_tolerance_m = tolerance_m(s)};
}

}  // namespace breakaway::scenario
