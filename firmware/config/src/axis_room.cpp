#include "axis_room.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::config {
namespace {

// The nearest place of so many digits that is not below this one, or not above it where `side` is -1.
std::string place_beside(double place_m, double side, int digits) {
  if (place_m == 0) return "0";
  const double unit = std::pow(10, std::floor(std::log10(std::abs(place_m))) + 1 - digits);
  const double units = side * std::ceil(side * place_m / unit);
  const auto text = [&](double whole) { return fmt::format("{:.{}g}", whole * unit, digits); };
  const std::string nearest = text(units);
  return side * (std::stod(nearest) - place_m) >= 0 ? nearest : text(units + side);
}

// As many digits as people write, and as many more as places take that are near to one another and far from zero.
int digits_between(double least_m, double most_m) {
  constexpr double usual = 6, most = 11;
  const double farthest_m = std::max(std::abs(least_m), std::abs(most_m));
  const double more = std::isfinite(farthest_m) ? std::ceil(std::log10(farthest_m / (most_m - least_m))) : 0;
  return static_cast<int>(std::clamp(usual + more, usual, most));
}

// What limits of position leave for targets that an approach may pass by this much.
std::string targets_between(const Limits& limits, double beyond_m) {
  const double least_m = limits.position_min_m + beyond_m, most_m = limits.position_max_m - beyond_m;
  if (least_m > most_m)
    return fmt::format("widen them to {:g} m on either side of every target", rounded_up(beyond_m, 3));
  const int digits = digits_between(limits.position_min_m, limits.position_max_m);
  const std::string least = std::isfinite(least_m) ? place_beside(least_m, 1, digits) : "";
  const std::string most = std::isfinite(most_m) ? place_beside(most_m, -1, digits) : "";
  if (least.empty()) return fmt::format("keep targets below {} m", most);
  if (most.empty()) return fmt::format("keep targets above {} m", least);
  return fmt::format("keep targets between {} and {} m", least, most);
}

// A kick must not run into a limit that the axis stops for.
void require_room_for_kicks(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const double kick_m_s = kick_peak_m_s(axis, report);
  if (!report.certified || !node.loop || axis.limits.speed_m_s >= kick_m_s) return;
  throw InputError{at_axis(node, axis) + fmt::format("[limits] speed_m_s is {:g}, below the {:g} m/s that the largest "
                                                     "kick gives the axis; raise it",
                                                     axis.limits.speed_m_s, rounded_up(kick_m_s, 4))};
}

// Of the coasts whose approach may be faster, and go further, than it is planned.
struct Approach {
  double beyond_m = 0, peak_m_s = 0;
};
Approach approach_of(const design::DesignReport& report) {
  if (report.braked) return {report.braked->approach_beyond_m, report.braked->approach_peak_m_s};
  if (report.work) return {report.work->approach_beyond_m, report.work->approach_peak_m_s};
  if (report.pd) return {report.pd->beyond_m, report.pd->approach_peak_m_s};
  return {};
}

// Nor must an approach, whose speed is off as readings and what is not known of the axis have it.
void require_room_for_speed(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const double peak_m_s = approach_of(report).peak_m_s;
  if (!report.certified || axis.limits.speed_m_s >= peak_m_s) return;
  const auto allowed_m_s = axis_parameters<double>(node, axis).max_approach_speed_m_s;
  throw InputError{
      at_axis(node, axis) +
      fmt::format("[limits] speed_m_s is {:g}, and an approach that is allowed {:.4g} m/s may reach {:g} "
                  "m/s; raise it to {:g} with [controller] max_approach_speed_m_s = {:g}, or know mass and "
                  "force gain better, or use a finer encoder",
                  axis.limits.speed_m_s, allowed_m_s, rounded_up(peak_m_s, 3), rounded_up(peak_m_s, 3), allowed_m_s)};
}

// An approach may go beyond its target.
void require_room_for_approaches(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const double beyond_m = approach_of(report).beyond_m;
  if (!report.certified || beyond_m == 0) return;
  if (!std::isfinite(beyond_m)) {
    if (!(axis.limits.following_error_m < unlimited)) return;
    throw InputError{
        at_axis(node, axis) +
        "[limits] following_error_m is given, and nothing says how fast an approach may be, nor from where "
        "it comes; state [limits] speed_m_s or position_m as well"};
  }
  if (axis.limits.following_error_m < beyond_m)
    throw InputError{at_axis(node, axis) +
                     fmt::format("[limits] following_error_m is {:g}, and an approach may go {:g} m beyond its target; "
                                 "raise it to that",
                                 axis.limits.following_error_m, rounded_up(beyond_m, 3))};
  const double turning_m = report.braked && !axis.controller.targets.empty() ? report.braked->turning_m : 0;
  if (axis.limits.following_error_m < turning_m)
    throw InputError{at_axis(node, axis) +
                     fmt::format("[limits] following_error_m is {:g}, and an axis whose target moves on the way may go "
                                 "on for {:g} m before it turns; raise it to that, or allow less speed",
                                 axis.limits.following_error_m, rounded_up(turning_m, 3))};
  const auto require = [&](double target_m) {
    const double least_m = axis.limits.position_min_m + beyond_m, most_m = axis.limits.position_max_m - beyond_m;
    if (target_m >= least_m && target_m <= most_m) return;
    throw InputError{
        at_axis(node, axis) +
        fmt::format("[controller] has a target at {:.10g} m, and an approach may go {:.3g} m beyond it, outside the "
                    "[limits] of position; {}",
                    target_m, beyond_m, targets_between(axis.limits, beyond_m))};
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
    return {report.braked->farthest_m, "brake",
            "narrow that, allow more speed, take a coarser encoder, or a stronger drive"};
  return {};
}

void require_reachable_targets(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const Farthest certified = farthest(report);
  if (!report.certified || !(certified.most_m < unlimited)) return;
  const double room_m = axis.limits.position_max_m - axis.limits.position_min_m;
  const auto require = [&](double way_m, std::string_view what) {
    if (way_m <= certified.most_m) return;
    throw InputError{at_axis(node, axis) +
                     fmt::format("{} {:g} m away, and under the coast \"{}\" an approach is certified "
                                 "over {:g} m at most; {}",
                                 what, way_m, certified.coast, rounded_down(certified.most_m, 4), certified.remedy)};
  };
  if (room_m < unlimited) return require(room_m, "[limits] of position let a target be");
  double from_m = axis.controller.target_m;
  for (const TargetChange& change : axis.controller.targets) {
    require(std::abs(change.position_m - from_m), "[controller] has a target that is");
    from_m = change.position_m;
  }
}

// A sample that is lost is no reason to stop.
void require_patience_with_samples(const Node& node, const Axis& axis, const design::DesignReport& report) {
  if (!report.certified || !node.loop || !axis.limits.feedback_timeout) return;
  const double least_s = 2.5 * node.period_s(), given_s = hal::seconds(*axis.limits.feedback_timeout);
  if (given_s >= least_s * (1 - 1e-9)) return;
  throw InputError{
      at_axis(node, axis) +
      fmt::format("[limits] feedback_timeout_s is {:g}, and one sample that is lost makes the newest up to "
                  "{:g} s old; raise it to {:g}",
                  given_s, 2 * node.period_s(), least_s)};
}

// A sag must not run into a limit either.
void require_room_for_sag(const Node& node, const Axis& axis, const design::DesignReport& report) {
  const Sag most = sag_of(node, axis);
  if (!report.certified || most.way_m == 0) return;
  const auto fail = [&](const std::string& limit) {
    throw InputError{
        at_axis(node, axis) +
        fmt::format("[controller] feedforward_N: until the drive gives it an axis whose brake opens sags by "
                    "up to {:g} m at up to {:g} m/s, and {}; raise that, or give the drive a faster current "
                    "loop, or a counterweight to the axis",
                    rounded_up(most.way_m, 3), rounded_up(most.speed_m_s, 3), limit)};
  };
  if (axis.limits.speed_m_s < most.speed_m_s) fail(fmt::format("[limits] speed_m_s is {:g}", axis.limits.speed_m_s));
  if (axis.limits.following_error_m < most.way_m)
    fail(fmt::format("[limits] following_error_m is {:g}", axis.limits.following_error_m));
  const auto require = [&](double target_m) {
    const bool falls = feedforward_N(axis) > 0;
    const double room_m = falls ? target_m - axis.limits.position_min_m : axis.limits.position_max_m - target_m;
    if (room_m < most.way_m)
      fail(fmt::format("[limits] of position are {:g} m from the target at {:g} m", room_m, target_m));
  };
  require(axis.controller.target_m);
  for (const TargetChange& change : axis.controller.targets) require(change.position_m);
}

}  // namespace

std::string at_axis(const Node& node, const Axis& axis) {
  return node.axes.size() == 1 ? std::string{} : fmt::format("axis {}: ", axis.name);
}

Sag sag_of(const Node& node, const Axis& axis) {
  const double given_N = feedforward_N(axis);
  const Uncertainty& u = axis.uncertainty;
  const double carried_N = std::abs(given_N) * (1 + u.force_gain) + u.force_N;
  const double friction_N = axis.friction.bounds.lower_N - u.force_N, mass_kg = axis.mass_kg * (1 - u.mass);
  if (given_N == 0 || !(friction_N > 0) || carried_N <= friction_N) return {};
  const double late_s = (axis.latency_periods + 1) * node.period_s() + u.jitter_s;
  const double lag_s = axis.drive->current_loop_time_constant_s * (1 + u.current_loop_time_constant);
  // Until friction exceeds what is lacking; all that is lacking from then on is counted as if it were so far, too.
  const double faster_s = late_s + lag_s * std::log(carried_N / friction_N);
  const double speed_m_s = (carried_N * (late_s + lag_s) - friction_N * faster_s) / mass_kg;
  return {speed_m_s * faster_s + mass_kg * speed_m_s * speed_m_s / (2 * friction_N), speed_m_s};
}

void require_room(const Node& node, const Axis& axis, const design::DesignReport& report) {
  require_room_for_kicks(node, axis, report);
  require_room_for_speed(node, axis, report);
  require_room_for_approaches(node, axis, report);
  require_reachable_targets(node, axis, report);
  require_room_for_sag(node, axis, report);
  require_patience_with_samples(node, axis, report);
}

}  // namespace breakaway::config
