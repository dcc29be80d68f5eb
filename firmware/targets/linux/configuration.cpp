#include "configuration.hpp"

#include <fmt/format.h>

#include <cmath>

#include "breakaway/design/flashed_header.hpp"
#include "breakaway/design/report.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/axis_config.hpp"
#include "breakaway/scenario/axis_design.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::linux_node {
namespace {

using scenario::Scenario;

void require_parts(const Scenario& s) {
  const auto lacks = [&](const char* part) {
    throw InputError{fmt::format("{}: has no {}; a node needs [loop] and [drive]", s.file, part)};
  };
  if (!s.loop) lacks("[loop]");
  if (!s.drive) lacks("[drive]");
}

// As `breakaway design --header` would flash it.
law::FlashedAxis<float> certified_axis(const Scenario& s) {
  const design::AxisDesign axis = scenario::axis_design(s);
  const auto report = design::design_axis(axis);
  if (!report.certified) {
    throw InputError{fmt::format("{}: not certified: {}; `breakaway design {}` shows every check", s.file,
                                 report.reasons.front(), s.file)};
  }
  const auto flashed = design::flashed_axis(scenario::axis_parameters<float>(s), axis, report);
  return flashed;
}

// A lower force limit is still covered by the certificate, as long as the axis can be moved with it.
void lower_force_limit(law::FlashedAxis<float>& axis, double max_force_N) {
  if (max_force_N > static_cast<double>(axis.limits.max_force_N) ||
      max_force_N < static_cast<double>(axis.limits.friction_upper_N)) {
    throw InputError{
        fmt::format("--max-force {}: the axis is certified for forces from {} N, its upper friction bound, to {} N; "
                    "choose one between",
                    max_force_N, axis.limits.friction_upper_N, axis.limits.max_force_N)};
  }
  axis.parameters.max_force_N = static_cast<float>(max_force_N);
  axis.checksum = law::checksum_of(axis);
}

void require_verified(const std::string& file, const law::FlashedAxis<float>& axis) {
  const auto error = law::verify(axis);
  if (error != law::FlashedAxisError::none) throw InputError{fmt::format("{}: {}", file, to_string(error))};
}

std::int32_t counts(double position_m, const Scenario& s) {
  const double exact = std::round(position_m / s.drive->encoder_resolution_m);
  if (!(std::abs(exact) < 2147483648.0) || std::abs(position_m) > s.limits.position_m) {
    throw InputError{fmt::format("target {} m: is beyond {}; choose one inside", position_m,
                                 std::isfinite(s.limits.position_m)
                                     ? fmt::format("[limits] position_m = {}", s.limits.position_m)
                                     : std::string{"the encoder's range"})};
  }
  return static_cast<std::int32_t>(exact);
}

void plan_visits(Configuration& c, const Scenario& s, const Options& options) {
  for (const double target_m : options.targets_m) c.visits.push_back({0, counts(target_m, s)});
  if (!c.visits.empty()) return;
  c.timed = true;
  c.visits.push_back({0, counts(s.controller.target_m, s)});
  for (const auto& change : s.controller.targets) c.visits.push_back({change.time_s, counts(change.position_m, s)});
}

}  // namespace

Configuration read_configuration(const Options& options) {
  const Scenario s = scenario::read_scenario(options.configuration);
  require_parts(s);
  Configuration c;
  c.axis = certified_axis(s);
  if (options.max_force_N > 0) lower_force_limit(c.axis, options.max_force_N);
  require_verified(s.file, c.axis);
  c.drive = scenario::drive_config<float>(s);
  if (options.node_id != 0) c.drive.node_id = static_cast<std::uint8_t>(options.node_id);
  c.loop = scenario::network_config(s);
  if (const auto error = cia402::check(c.drive, c.loop, c.scale()); error != cia402::DriveConfigError::none)
    throw InputError{fmt::format("{}: [drive] or [loop] cannot be used: {}", s.file, to_string(error))};
  c.limits = scenario::axis_limits<float>(s);
  c.tolerance_m = s.run && s.run->settle_tolerance_m > 0 ? s.run->settle_tolerance_m
                                                         : static_cast<double>(c.axis.parameters.position_tolerance_m);
  c.force_per_per_mille_N = static_cast<float>(1e-6 * s.drive->rated_torque_mNm * s.drive->force_per_torque_N_per_Nm);
  plan_visits(c, s, options);
  return c;
}

}  // namespace breakaway::linux_node
