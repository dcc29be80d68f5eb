#include "configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"

namespace breakaway::linux_node {
namespace {

using config::Axis;
using config::Node;

void apply_node_id(Node& node, unsigned node_id) {
  if (node.axes.size() > 1)
    throw InputError{"--node-id: the file has several axes; give each its [drive] node_id there"};
  node.axes.front().drive->node_id = static_cast<std::uint8_t>(node_id);
}

// Before the design is checked, so that what runs is what was certified.
void lower_force_limit(Axis& axis, double max_force_N) {
  const double most_N = std::min(axis.controller.max_force_N, axis.drive->max_force_N());
  const double least_N = axis.friction.bounds.upper_N;
  if (max_force_N > most_N || max_force_N < least_N) {
    throw InputError{fmt::format(
        "--max-force {}: axis {} is certified for forces from {} N, its upper friction bound, to {} N; choose one "
        "between",
        max_force_N, axis.name, least_N, most_N)};
  }
  axis.controller.max_force_N = max_force_N;
}

std::int32_t counts(double position_m, const Axis& axis) {
  if (const std::string problem = config::target_problem(position_m, axis); !problem.empty())
    throw InputError{fmt::format("target {} m of axis {}: {}", position_m, axis.name, problem)};
  return static_cast<std::int32_t>(std::round(position_m / axis.drive->encoder_resolution_m));
}

// "0.1" is a place for every axis, "0.1,-0.2" one for each of two.
std::vector<double> places(const std::string& text, std::size_t axes) {
  std::vector<double> numbers;
  std::istringstream parts{text + ","};
  for (std::string part; std::getline(parts, part, ',');) {
    std::size_t used = 0;
    double number = 0;
    try {
      number = std::stod(part, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || used != part.size() || !(std::abs(number) <= 1e9))
      throw InputError{fmt::format("--target {}: \"{}\" is not a position in m", text, part)};
    numbers.push_back(number);
  }
  if (numbers.size() == 1) numbers.assign(axes, numbers.front());
  if (numbers.size() != axes)
    throw InputError{fmt::format("--target {}: names {} positions for {} axes; give one for each, or one for all", text,
                                 numbers.size(), axes)};
  return numbers;
}

void plan_tour(Configuration& c, const Node& node, const std::vector<std::string>& targets) {
  for (const std::string& target : targets) {
    const std::vector<double> stop = places(target, node.axes.size());
    for (std::size_t i = 0; i < stop.size(); ++i) c.axes[i].visits.push_back({0, counts(stop[i], node.axes[i])});
  }
}

void plan_times(AxisPlan& plan, const Axis& axis) {
  plan.visits.push_back({0, counts(axis.controller.target_m, axis)});
  for (const auto& change : axis.controller.targets)
    plan.visits.push_back({change.time_s, counts(change.position_m, axis)});
}

}  // namespace

Configuration read_configuration(const Options& options) {
  Node node = config::read_node(options.configuration);
  config::require_flashable(node);
  if (config::is_by_work(node))
    throw InputError{
        "[controller] coast = \"work\" is for images that are compiled with the node's header; this program "
        "runs \"pd\" and \"brake\""}
        .in_file(node.file);
  if (options.node_id != 0) apply_node_id(node, options.node_id);
  if (options.max_force_N > 0)
    for (Axis& axis : node.axes) lower_force_limit(axis, options.max_force_N);
  Configuration c{.node = config::certified(node, config::examine(node)), .axes = {}, .timed = options.targets.empty()};
  for (std::size_t i = 0; i < node.axes.size(); ++i) {
    const Axis& axis = node.axes[i];
    const double promised_m = std::max(tolerance_m(node, axis), double{c.node.axes[i].kicks.fine_floor_m});
    // Half a count for the decimal tolerance in float.
    c.axes.push_back({.name = axis.name,
                      .visits = {},
                      .reached_m = promised_m + reading_error_m(axis),
                      .resolution_m = axis.drive->encoder_resolution_m,
                      .force_per_per_mille_N = static_cast<float>(axis.drive->force_quantum_N()),
                      .max_torque_per_mille = axis.drive->max_torque_per_mille});
    if (c.timed) plan_times(c.axes.back(), axis);
  }
  plan_tour(c, node, options.targets);
  return c;
}

}  // namespace breakaway::linux_node
