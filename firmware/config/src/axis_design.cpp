#include "breakaway/config/axis_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/config/rounding.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/shell_word.hpp"
#include "outside_class.hpp"

namespace breakaway::config {
namespace {

// Where there is one axis only, naming the file is enough.
std::string place(const Node& node, const Axis& axis) {
  return node.axes.size() == 1 ? std::string{} : fmt::format("axis {}: ", axis.name);
}

// The ideal law reaches any accuracy, so there it may be left out.
double accuracy_m(const Node& node, const Axis& axis) {
  if (const double asked_m = tolerance_m(node, axis); asked_m > 0) return asked_m;
  if (!node.loop) return node.settle_tolerance_m > 0 ? node.settle_tolerance_m : std::numeric_limits<double>::min();
  throw InputError{place(node, axis) +
                   "[controller] position_tolerance_m is missing: say which accuracy the axis shall reach"};
}

// The drive gives force in steps; of what the law may ask for, it gives the whole steps.
double granted_N(const Axis& axis, double force_N) {
  if (!axis.drive || !(force_N < unlimited)) return force_N;
  const double step_N = force_step_N(axis), steps = force_N / step_N;
  return std::abs(steps - std::round(steps)) < 1e-6 ? force_N : std::floor(steps) * step_N;
}

// To so many digits that people write, towards 0 on the side of `sign`, away from it on the other one.
double rounded_inwards(double value, double sign) {
  constexpr int digits = 6;
  if (value == 0) return 0;
  const double size = std::abs(value);
  return std::copysign(value * sign > 0 ? rounded_down(size, digits) : rounded_up(size, digits), value);
}

// A kick must not run into a limit that the axis stops for.
void require_room_for_kicks(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const double kick_m_s = report.braked ? report.braked->peak_speed_m_s
                          : report.work ? report.work->peak_speed_m_s
                                        : report.largest_impulse_Ns / axis.mass_kg;
  if (!report.certified || !node.loop || axis.limits.speed_m_s >= kick_m_s) return;
  throw InputError{place(node, axis) + fmt::format("[limits] speed_m_s is {:g}, below the {:g} m/s that the largest "
                                                   "kick gives the axis; raise it",
                                                   axis.limits.speed_m_s, rounded_up(kick_m_s, 4))};
}

// Nor must an approach, whose speed is off as readings and what is not known of the axis have it.
void require_room_for_speed(const Node& node, const Axis& axis, const design::DesignReport& report) {
  if (!report.certified || !report.braked || axis.limits.speed_m_s >= report.braked->approach_peak_m_s) return;
  const auto allowed_m_s = axis_parameters<double>(node, axis).max_approach_speed_m_s;
  const double peak_m_s = report.braked->approach_peak_m_s;
  throw InputError{
      place(node, axis) +
      fmt::format("[limits] speed_m_s is {:g}, and an approach that is allowed {:.4g} m/s may reach {:g} "
                  "m/s; raise it to {:g} with [controller] max_approach_speed_m_s = {:g}, or know mass and "
                  "force gain better, or use a finer encoder",
                  axis.limits.speed_m_s, allowed_m_s, rounded_up(peak_m_s, 3), rounded_up(peak_m_s, 3), allowed_m_s)};
}

// An approach may go beyond its target.
void require_room_for_approaches(const Node& node, const Axis& axis, const design::DesignReport& report) {
  if (!report.certified || !report.braked) return;
  const double beyond_m = report.braked->approach_beyond_m;
  const auto require = [&](double target_m) {
    const double least_m = axis.limits.position_min_m + beyond_m, most_m = axis.limits.position_max_m - beyond_m;
    if (target_m >= least_m && target_m <= most_m) return;
    const std::string remedy =
        least_m <= most_m ? fmt::format("keep targets between {:.6g} and {:.6g} m", rounded_inwards(least_m, -1),
                                        rounded_inwards(most_m, 1))
                          : fmt::format("widen them to {:g} m on either side of every target", rounded_up(beyond_m, 3));
    throw InputError{
        place(node, axis) +
        fmt::format("[controller] has a target at {:g} m, and an approach may go {:.3g} m beyond it, outside the "
                    "[limits] of position; {}",
                    target_m, beyond_m, remedy)};
  };
  require(axis.controller.target_m);
  for (const TargetChange& change : axis.controller.targets) require(change.position_m);
}

// Under the coast "work" an approach counts its periods, and a float holds its plan, over so much only. Under "brake" a
// float must tell a slow axis that sets off from one that sticks.
struct Farthest {
  double most_m = unlimited;
  std::string_view coast, remedy;
};
Farthest farthest(const design::DesignReport& report) {
  if (report.work) return {report.work->farthest_m, "work", "narrow that, or raise max_approach_speed_m_s"};
  if (report.braked)
    return {report.braked->farthest_m, "brake", "narrow that, take a coarser encoder, or a stronger drive"};
  return {};
}

void require_reachable_targets(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const Farthest certified = farthest(report);
  if (!report.certified || !(certified.most_m < unlimited)) return;
  const double room_m = axis.limits.position_max_m - axis.limits.position_min_m;
  const auto require = [&](double way_m, std::string_view what) {
    if (way_m <= certified.most_m) return;
    throw InputError{place(node, axis) +
                     fmt::format("{} {:g} m away, and under the coast \"{}\" an approach is certified "
                                 "over {:.4g} m at most; {}",
                                 what, way_m, certified.coast, certified.most_m, certified.remedy)};
  };
  if (room_m < unlimited) return require(room_m, "[limits] of position let a target be");
  double from_m = axis.controller.target_m;
  for (const TargetChange& change : axis.controller.targets) {
    require(std::abs(change.position_m - from_m), "[controller] has a target that is");
    from_m = change.position_m;
  }
}

void require_room(const Node& node, const Axis& axis, const design::DesignReport& report) {
  require_room_for_kicks(node, axis, report);
  require_room_for_speed(node, axis, report);
  require_room_for_approaches(node, axis, report);
  require_reachable_targets(node, axis, report);
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
    throw InputError{place(node, axis) + "[controller] kind is \"pid\"; design checks the impulsive law only"}.in_file(
        node.file);
  const auto p = axis_parameters<double>(node, axis);
  return {.mass_kg = p.mass_kg,
          .stiffness_N_per_m = p.stiffness_N_per_m,
          .approach_damping_Ns_per_m = p.approach_damping_Ns_per_m,
          .kick_damping_Ns_per_m = p.kick_damping_Ns_per_m,
          .friction = p.friction,
          .smooth_friction_slope_Ns_per_m = axis.friction.smooth_slope_Ns_per_m,
          .max_force_N = std::min(granted_N(axis, p.max_force_N), std::numeric_limits<double>::max()),
          .period_s = p.period_s,
          .encoder_resolution_m = p.encoder_resolution_m,
          .latency_ticks = p.latency_periods,
          .current_loop_lag_s = axis.drive ? axis.drive->current_loop_time_constant_s : 0,
          .position_tolerance_m = accuracy_m(node, axis),
          .max_approach_speed_m_s = p.max_approach_speed_m_s,
          .least_period_s = least_period_s(node),
          .longest_way_m = longest_way_m(node, axis),
          .following_error_m = axis.limits.following_error_m,
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

void require_certified(const Node& node, const std::vector<design::DesignReport>& reports) {
  for (std::size_t i = 0; i < reports.size(); ++i) {
    if (reports[i].certified) continue;
    throw InputError{fmt::format("{}not certified: {}; `breakaway design {}` shows every check",
                                 place(node, node.axes[i]), reports[i].reasons.front(), shell_word(node.file))}
        .in_file(node.file);
  }
}

}  // namespace breakaway::config
