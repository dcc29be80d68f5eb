#include "breakaway/scenario/axis_design.hpp"

#include <algorithm>
#include <limits>

#include "breakaway/scenario/input_error.hpp"
#include "breakaway/scenario/run_bus_scene.hpp"

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
          .friction = {p.friction_lower_N, p.friction_upper_N},
          .smooth_friction_slope_Ns_per_m = s.friction.smooth_slope_Ns_per_m,
          .max_force_N = max_force_N(s),
          .period_s = p.period_s,
          .encoder_resolution_m = p.encoder_resolution_m,
          .latency_ticks = p.latency_periods,
          .position_tolerance_m = tolerance_m(s)};
}

}  // namespace breakaway::scenario
