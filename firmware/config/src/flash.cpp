#include "breakaway/config/flash.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/design/approach_time.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::config {

namespace {

[[noreturn]] void refuse(const Node& node, const Axis& axis, const std::string& what) {
  const std::string prefix = node.axes.size() > 1 ? "axis " + axis.name + ": " : std::string{};
  throw InputError{prefix + what}.in_file(node.file);
}

}  // namespace

bool speaks_odrive(const Node& node) {
  return std::ranges::any_of(node.axes, [](const Axis& axis) { return axis.drive && axis.drive->odrive; });
}

void require_runnable(const Node& node) {
  if (!node.loop)
    throw InputError{"[loop] is missing: what runs on a controller needs its period_s"}.in_file(node.file);
  for (const Axis& axis : node.axes) {
    if (!axis.drive) refuse(node, axis, "[drive] is missing: what runs on a controller needs one");
    if (!axis.controller.impulsive)
      refuse(node, axis, "[controller] kind is \"pid\"; a node runs the impulsive law only: leave kind out");
  }
}

void require_flashable(const Node& node) {
  require_runnable(node);
  if (speaks_odrive(node))
    refuse(
        node, node.axes.front(),
        "[drive] protocol is \"odrive\", which a PC speaks (breakaway-node, `simulate`, `study`); boards, their header "
        "and EDS, and what watches a bus speak \"canopen\"");
}

firmware::LoopConfig loop_config(const Node& node) {
  return {.network = {.period = node.loop->period,
                      .bit_rate = *node.bit_rate,
                      .node_id = node.loop->node_id,
                      .heartbeat_period = node.loop->heartbeat_period},
          .fault_scope = node.loop->fault_scope,
          .moves_end = node.loop->moves_end,
          .command_timeout = node.loop->command_timeout};
}

namespace {

cia402::HomingConfig homing_config(const Drive& d) {
  const auto counts = [&](double metres) { return std::llround(metres / d.encoder_resolution_m); };
  const auto rate = [&](const std::optional<double>& metres) {
    return metres ? static_cast<std::uint32_t>(std::max(counts(*metres), 1LL)) : 0U;
  };
  return {.home = d.homing.home,
          .position_counts = static_cast<std::int32_t>(counts(d.homing.position_m)),
          .method = d.homing.method,
          .search_counts_s = rate(d.homing.speed_m_s),
          .zero_counts_s = rate(d.homing.zero_speed_m_s),
          .acceleration_counts_s2 = rate(d.homing.acceleration_m_s2),
          .timeout = d.homing.timeout};
}

}  // namespace

template <class Real>
cia402::DriveConfig<Real> drive_config(const Axis& axis) {
  const Drive& d = *axis.drive;
  return {.node_id = d.node_id,
          .force_per_torque_N_per_Nm = static_cast<Real>(d.force_per_torque_N_per_Nm),
          .rated_torque_mNm = d.rated_torque_mNm,
          .heartbeat_period = d.heartbeat_period,
          .heartbeat_timeout = d.heartbeat_timeout,
          .sdo_timeout = d.sdo_timeout,
          .torque_base = d.torque_base,
          .user_position_unit = d.user_position_unit,
          .invert_direction = d.invert_direction,
          .absolute_encoder = d.absolute_encoder,
          .homing = homing_config(d),
          .emcy_information = d.emcy_information};
}

template <class Real>
odrive::DriveConfig<Real> odrive_config(const Axis& axis) {
  const Drive& d = *axis.drive;
  const Odrive& o = *d.odrive;
  const double current_A =
      o.torque_constant_Nm_per_A ? max_force_N(axis) / d.force_per_torque_N_per_Nm / *o.torque_constant_Nm_per_A : 0;
  return {.node_id = d.node_id,
          .force_per_torque_N_per_Nm = static_cast<Real>(d.force_per_torque_N_per_Nm),
          .max_torque_Nm = static_cast<Real>(o.max_torque_Nm),
          .counts_per_turn = o.travel_per_turn_m / d.encoder_resolution_m,
          .velocity_limit_turns_s = static_cast<float>(o.velocity_limit_turns_s.value_or(0)),
          .current_limit_A = static_cast<float>(current_A),
          .estimates = o.estimates,
          .estimate_period = o.estimate_period,
          .heartbeat_period = d.heartbeat_period,
          .heartbeat_timeout = d.heartbeat_timeout,
          .invert_direction = d.invert_direction,
          .absolute_encoder = d.absolute_encoder,
          .home_here = d.homing.home == cia402::Home::here,
          .home_counts = homing_config(d).position_counts};
}

namespace {

// The position of the count nearest to this one, as a drive makes it of its counts. Far from zero Real holds no count
// exactly, and what it makes of the last one that is allowed may be beyond what it makes of the limit.
template <class Real>
Real shown_m(double position_m, const Axis& axis) {
  if (!axis.drive || !is_counted(position_m, axis)) return static_cast<Real>(position_m);
  const double count_m = axis.drive->encoder_resolution_m;
  return static_cast<Real>(std::llround(position_m / count_m)) * static_cast<Real>(count_m);
}

}  // namespace

template <class Real>
firmware::AxisLimits<Real> axis_limits(const Axis& axis) {
  const Limits& l = axis.limits;
  firmware::AxisLimits<Real> limits;
  limits.position_min_m = std::min(static_cast<Real>(l.position_min_m), shown_m<Real>(l.position_min_m, axis));
  limits.position_max_m = std::max(static_cast<Real>(l.position_max_m), shown_m<Real>(l.position_max_m, axis));
  limits.speed_m_s = static_cast<Real>(l.speed_m_s);
  limits.force_N = static_cast<Real>(l.force_N);
  limits.following_error_m = static_cast<Real>(l.following_error_m);
  limits.feedback_timeout = l.feedback_timeout.value_or(hal::Duration::zero());
  return limits;
}

template cia402::DriveConfig<float> drive_config(const Axis&);
template cia402::DriveConfig<double> drive_config(const Axis&);
template odrive::DriveConfig<float> odrive_config(const Axis&);
template odrive::DriveConfig<double> odrive_config(const Axis&);
template firmware::AxisLimits<float> axis_limits(const Axis&);
template firmware::AxisLimits<double> axis_limits(const Axis&);

namespace {

double approach_m_s(const Node& node, const Axis& axis) {
  return axis_parameters<double>(node, axis).max_approach_speed_m_s;
}

template <class Real, class Kicks>
Kicks kicks_of(const Node& node, const Axis& axis) {
  const design::BrakedClass axes = braked_class(node, axis);
  if constexpr (std::is_same_v<Kicks, law::BrakedKicks<Real>>)
    return design::design_braked_kicks<Real>(axes).kicks;
  else
    return axes.spring_load ? design::design_work_kicks<Real>(axes, approach_m_s(node, axis)).kicks : Kicks{};
}

// In which an axis may come no nearer to its target; 0 where nothing is known of it.
double without_progress_s(const Node& node, const Axis& axis) {
  if (!node.loop || !axis.controller.impulsive) return 0;
  if (axis.controller.impulsive->coast == law::Coast::pd) {
    const design::DesignReport report = design::design_axis(axis_design(node, axis));
    return report.pd ? report.pd->without_progress_s : 0;
  }
  const design::BrakedClass axes = braked_class(node, axis);
  if (axis.controller.impulsive->coast == law::Coast::work) {
    if (!axes.spring_load) return 0;
    const auto design = design::design_work_kicks<float>(axes, approach_m_s(node, axis));
    return design.possible() ? design::without_progress_s(axes, design) : 0;
  }
  const auto design = design::design_braked_kicks<float>(axes);
  if (!design.possible()) return 0;
  const double tolerance = std::max(tolerance_m(node, axis), design.least_tolerance_m);
  return design::without_progress_s(axes, design, approach_m_s(node, axis), tolerance);
}

// No less than what the supervisor has by itself, and as much as the certificate of a slow axis needs.
hal::Duration progress_timeout(const Node& node, const Axis& axis) {
  const hal::Duration usual = firmware::AxisLimits<double>{}.progress_timeout;
  const double lawful_s = without_progress_s(node, axis);
  constexpr double longest_s = 1e6;
  if (!(lawful_s <= longest_s)) return usual;
  return std::max(usual, std::chrono::duration_cast<hal::Duration>(
                             std::chrono::milliseconds{std::llround(std::ceil(1e3 * lawful_s))}));
}

template <class Real>
firmware::AxisLimits<Real> limits_under_law(const Node& node, const Axis& axis) {
  firmware::AxisLimits<Real> limits = axis_limits<Real>(axis);
  limits.progress_timeout = progress_timeout(node, axis);
  return limits;
}

template <class Real>
design::PdKicks<Real> pd_kicks(const Axis& axis, const law::AxisParameters<Real>& p) {
  const auto aim = axis.controller.impulsive->kick == Kick::naive ? design::PulseAim::k3 : design::PulseAim::target;
  return design::design_pd_kicks(p, axis.drive->current_loop_time_constant_s, aim);
}

template <class Real, class Kicks>
firmware::FlashedAxis<Real, Kicks> flashed_axis(const Node& node, const Axis& axis) {
  // What is flashed has no place for an ODrive: odrive_config() is what commands one.
  const bool canopen = !axis.drive->odrive;
  const law::AxisParameters<Real> p = axis_parameters<Real>(node, axis);
  if (const auto error = law::validate(p); error != law::ParameterError::none)
    throw InputError{fmt::format("axis {}: in {}: {}", axis.name, std::is_same_v<Real, float> ? "float" : "double",
                                 to_string(error))};
  const auto built = design::build_k3_table<Real>(
      {p.mass_kg, p.stiffness_N_per_m, p.kick_damping_Ns_per_m, p.friction.lower_N}, p.stick_radius_upper_m());
  firmware::FlashedAxis<Real, Kicks> flashed{.drive = canopen ? drive_config<Real>(axis) : cia402::DriveConfig<Real>{},
                                             .limits = limits_under_law<Real>(node, axis),
                                             .law = p,
                                             .k3_table = built.table};
  if (p.coast == law::Coast::pd) {
    flashed.kicks.table = pd_kicks(axis, p).table;
  } else {
    flashed.kicks = kicks_of<Real, Kicks>(node, axis);
    if (!law::are_usable(flashed.kicks))
      throw InputError{
          fmt::format("axis {}: no kick under the coast \"{}\" is sure to move it; `breakaway design` "
                      "says why",
                      axis.name, p.coast == law::Coast::brake ? "brake" : "work")};
  }
  std::ranges::copy(axis.name, flashed.name.characters.begin());
  return flashed;
}

}  // namespace

namespace {

template <class Real, class Kicks>
AnyNode<Real, Kicks> flashed_with(const Node& node) try {
  AnyNode<Real, Kicks> flashed;
  flashed.loop = loop_config(node);
  flashed.wiring = node.wiring;
  flashed.count = static_cast<std::uint8_t>(node.axes.size());
  std::ranges::transform(node.axes, flashed.axes.begin(),
                         [&](const Axis& axis) { return flashed_axis<Real, Kicks>(node, axis); });
  flashed.checksum = checksum_of(flashed);
  return flashed;
} catch (const InputError& error) {
  throw error.file().empty() ? error.in_file(node.file) : error;
}

// What runs is checked in the numbers that it runs with.
template <class Kicks>
void verify(const AnyNode<float, Kicks>& flashed, const Node& node) {
  const auto refuse = [&](const Axis& axis, std::string_view what) {
    throw InputError{fmt::format("axis {}, in float: {}", axis.name, what)}.in_file(node.file);
  };
  if (!speaks_odrive(node)) {
    const firmware::NodeVerdict verdict = firmware::verify(flashed);
    if (!verdict.ok()) refuse(node.axes[verdict.axis], to_string(verdict.error));
    return;
  }
  for (std::size_t i = 0; i < flashed.count; ++i) {
    const auto error = odrive::check(odrive_config<float>(node.axes[i]), flashed.loop.network, flashed.axes[i].scale());
    if (error != odrive::DriveConfigError::none) refuse(node.axes[i], to_string(error));
  }
}

template <class Kicks>
AnyNode<float, Kicks> certified_with(const Node& node, const std::vector<design::DesignReport>& reports) {
  require_runnable(node);
  if (node.coupling)
    throw InputError{"[coupling] is of axes that one coordinator moves, and these are laws of single ones"}.in_file(
        node.file);
  require_certified(node, reports);
  auto result = flashed_with<float, Kicks>(node);
  for (std::size_t i = 0; i < result.count; ++i) result.axes[i].certified = true;
  result.checksum = checksum_of(result);
  verify(result, node);
  return result;
}

}  // namespace

bool is_by_work(const Node& node) {
  const auto by_work = [](const Axis& axis) {
    return axis.controller.impulsive && axis.controller.impulsive->coast == law::Coast::work;
  };
  const bool first = by_work(node.axes.front());
  for (const Axis& axis : node.axes) {
    if (by_work(axis) == first) continue;
    throw InputError{"axis " + axis.name +
                     ": [controller] coast is \"work\" for some axes of the node and not for others; give those with a "
                     "load on a spring a node of their own"}
        .in_file(node.file);
  }
  return first;
}

template <class Real>
AnyNode<Real> flashed(const Node& node) {
  return flashed_with<Real, law::BrakedKicks<Real>>(node);
}
template <class Real>
WorkNode<Real> flashed_by_work(const Node& node) {
  return flashed_with<Real, law::WorkKicks<Real>>(node);
}

template AnyNode<float> flashed(const Node&);
template AnyNode<double> flashed(const Node&);
template WorkNode<float> flashed_by_work(const Node&);
template WorkNode<double> flashed_by_work(const Node&);

AnyNode<float> certified(const Node& node, const std::vector<design::DesignReport>& reports) {
  return certified_with<law::BrakedKicks<float>>(node, reports);
}
WorkNode<float> certified_by_work(const Node& node, const std::vector<design::DesignReport>& reports) {
  return certified_with<law::WorkKicks<float>>(node, reports);
}

void require_flashable(const Node& node, const std::vector<design::DesignReport>& reports) {
  if (!node.loop || !std::ranges::all_of(reports, &design::DesignReport::certified)) return;
  if (is_by_work(node))
    certified_by_work(node, reports);
  else
    certified(node, reports);
}

}  // namespace breakaway::config
