#include "breakaway/config/axis_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "axis_room.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/input/shell_word.hpp"
#include "outside_class.hpp"

namespace breakaway::config {
namespace {

// The ideal law reaches any accuracy, so there it may be left out.
double accuracy_m(const Node& node, const Axis& axis) {
  if (const double asked_m = tolerance_m(node, axis); asked_m > 0) return asked_m;
  if (!node.loop) return node.settle_tolerance_m > 0 ? node.settle_tolerance_m : std::numeric_limits<double>::min();
  throw InputError{at_axis(node, axis) +
                   "[controller] position_tolerance_m is missing: say which accuracy the axis shall reach"};
}

// Of a move, or from one end of the travel to the other. Where moves end together, each waits for the slowest.
double longest_way_m(const Node& node, const Axis& axis) {
  if (node.axes.size() > 1 && node.loop && node.loop->moves_end == firmware::MovesEnd::together) return 0;
  if (axis.move) return axis.move->distance_m;
  const double room_m = axis.limits.position_max_m - axis.limits.position_min_m;
  return room_m < unlimited ? room_m : 0;
}

}  // namespace

design::AxisDesign axis_design(const Node& node, const Axis& axis) {
  if (!axis.controller.impulsive)
    throw InputError{at_axis(node, axis) +
                     "[controller] kind is \"pid\"; design checks the impulsive law only: "
                     "leave kind out for that one, or try this one by `breakaway study`"}
        .in_file(node.file);
  const auto p = axis_parameters<double>(node, axis);
  return {.mass_kg = p.mass_kg,
          .stiffness_N_per_m = p.stiffness_N_per_m,
          .approach_damping_Ns_per_m = p.approach_damping_Ns_per_m,
          .kick_damping_Ns_per_m = p.kick_damping_Ns_per_m,
          .friction = p.friction,
          .smooth_friction_slope_Ns_per_m = axis.friction.smooth_slope_Ns_per_m,
          .max_force_N = std::min(granted_N(axis, p.max_force_N), std::numeric_limits<double>::max()),
          .force_step_N = axis.drive ? force_step_N(axis) : 0,
          .period_s = p.period_s,
          .encoder_resolution_m = p.encoder_resolution_m,
          .latency_ticks = p.latency_periods,
          .current_loop_lag_s = axis.drive ? axis.drive->current_loop_time_constant_s : 0,
          .position_tolerance_m = accuracy_m(node, axis),
          .max_approach_speed_m_s = p.max_approach_speed_m_s,
          .least_period_s = least_period_s(node),
          .longest_way_m = longest_way_m(node, axis),
          .following_error_m = axis.limits.following_error_m,
          .sag_m = sag_of(node, axis).way_m,
          .settle_tolerance_m = node.settle_tolerance_m,
          .braked = p.coast == law::Coast::brake ? std::optional{braked_class(node, axis)} : std::nullopt,
          .work = p.coast == law::Coast::work ? std::optional{braked_class(node, axis)} : std::nullopt,
          .outside = outside_class(node, axis)};
}

std::vector<design::DesignReport> examine(const Node& node) try {
  require_fitting_bus(node);
  std::vector<design::DesignReport> reports;
  for (const Axis& axis : node.axes) {
    reports.push_back(design::design_axis(axis_design(node, axis)));
    require_room(node, axis, reports.back());
  }
  return reports;
} catch (const InputError& error) {
  throw error.file().empty() ? error.in_file(node.file) : error;
}

std::string why_not_certified(const Node& node, const Axis& axis) try {
  if (node.coupling) return examine_machine(node).reason;
  const design::DesignReport report = design::design_axis(axis_design(node, axis));
  require_room(node, axis, report);
  return report.certified ? std::string{} : report.reasons.front();
} catch (const InputError& error) {
  return error.what();
}

namespace {

// Of the moves to the target and to those that follow the longest, where it is longer than moves are certified for.
std::string too_long_move(const Axis& axis, double start_m) {
  if (!axis.move) return {};
  double from_m = axis.controller.target_m, longest_m = std::abs(start_m - from_m);
  for (const TargetChange& next : axis.controller.targets) {
    longest_m = std::max(longest_m, std::abs(next.position_m - from_m));
    from_m = next.position_m;
  }
  constexpr double rounding = 1e-9;
  if (longest_m <= axis.move->distance_m * (1 + rounding)) return {};
  const auto [asked, certified] = compared(longest_m, axis.move->distance_m);
  return fmt::format("a move of {} m is longer than [move] distance_m = {}", asked, certified);
}

}  // namespace

std::string outside_certificate(const Axis& axis, double start_m, double start_m_s) {
  if (start_m_s != 0) return fmt::format("it begins at {:g} m/s, and an axis is to rest when it is enabled", start_m_s);
  return too_long_move(axis, start_m);
}

double kick_peak_m_s(const Axis& axis, const design::DesignReport& report) {
  if (report.braked) return report.braked->kick_peak_m_s;
  if (report.work) return report.work->kick_peak_m_s;
  return report.largest_impulse_Ns / axis.mass_kg;
}

void require_certified(const Node& node, const std::vector<design::DesignReport>& reports) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (reports[i].certified) continue;
    throw InputError{fmt::format("{}not certified: {}; `breakaway design {}` shows every check",
                                 at_axis(node, node.axes[i]), reports[i].reasons.front(), shell_word(node.file))}
        .in_file(node.file);
  }
}

}  // namespace breakaway::config
