#include "configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/experiment.hpp"
#include "breakaway/config/machine_design.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/odrive/messages.hpp"

namespace breakaway::linux_node {
namespace {

using config::Axis;
using config::Node;

void set_node_id(config::Drive& drive, unsigned node_id) {
  if (drive.odrive && node_id > odrive::most_node_id)
    throw InputError{fmt::format("--node-id {}: an ODrive has one of 0 to {}", node_id, odrive::most_node_id)};
  if (!drive.odrive && node_id == 0) throw InputError{"--node-id 0: a CANopen drive has one of 1 to 126"};
  drive.node_id = static_cast<std::uint8_t>(node_id);
}

void apply_node_id(Node& node, unsigned node_id) {
  if (node.axes.size() > 1)
    throw InputError{"--node-id: the file has several axes; give each its [drive] node_id there"};
  set_node_id(*node.axes.front().drive, node_id);
}

// Before the design is checked, so that what runs is what was certified.
void lower_force_limit(Axis& axis, double max_force_N) {
  const double most_N = std::min(axis.controller.max_force_N, axis.drive->max_force_N());
  const double least_N = axis.friction.bounds.upper_N;
  constexpr double rounding = 1e-12;  // the drive's is a product
  if (max_force_N > most_N * (1 + rounding) || max_force_N < least_N) {
    throw InputError{
        fmt::format("--max-force {:g}: axis {} has {:g} N, and its upper friction bound is {:g} N; choose one between",
                    max_force_N, axis.name, most_N, least_N)};
  }
  axis.controller.max_force_N = std::min(max_force_N, most_N);
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

// From the newest but one to the newest.
void require_near(const AxisPlan& plan, const Node& node, const Axis& axis) {
  if (plan.visits.size() < 2) return;
  const auto at_m = [&](const Visit& visit) { return static_cast<double>(visit.counts) * plan.resolution_m; };
  const std::string far = config::way_problem(node, axis, at_m(*(plan.visits.end() - 2)), at_m(plan.visits.back()));
  if (!far.empty()) throw InputError{fmt::format("--target: axis {} goes {}", plan.name, far)};
}

void plan_tour(Configuration& c, const Node& node, const std::vector<std::string>& targets) {
  for (const std::string& target : targets) {
    const std::vector<double> stop = places(target, node.axes.size());
    for (std::size_t i = 0; i < stop.size(); ++i) {
      c.axes[i].visits.push_back({0, counts(stop[i], node.axes[i])});
      require_near(c.axes[i], node, node.axes[i]);
    }
  }
}

void plan_times(AxisPlan& plan, const Axis& axis) {
  plan.visits.push_back({0, counts(axis.controller.target_m, axis)});
  for (const auto& change : axis.controller.targets)
    plan.visits.push_back({change.time_s, counts(change.position_m, axis)});
}

decltype(Configuration::node) certified(const Node& node) {
  if (node.coupling) return config::certified_machine(node, config::examine_machine(node));
  const std::vector<design::DesignReport> reports = config::examine(node);
  if (config::is_by_work(node)) return config::certified_by_work(node, reports);
  return config::certified(node, reports);
}

// 0 of an axis without a fine stage.
double fine_floor_m(const Configuration& c, std::size_t place) {
  const auto* const single = std::get_if<config::AnyNode<float>>(&c.node);
  return single != nullptr ? double{single->axes[place].kicks.fine_floor_m} : 0;
}

// But for its visits and how near it must come to them.
AxisPlan unplanned(const Axis& axis) {
  return {.name = axis.name,
          .visits = {},
          .resolution_m = axis.drive->encoder_resolution_m,
          .force_per_per_mille_N = static_cast<float>(axis.drive->force_quantum_N()),
          .max_torque_per_mille = axis.drive->max_torque_per_mille};
}

Axis axis_to_identify(const Node& node, const std::string& name) {
  if (name.empty() && node.axes.size() == 1) return node.axes.front();
  for (const Axis& axis : node.axes)
    if (axis.name == name) return axis;
  throw InputError{name.empty() ? "has several axes: say which to identify with --axis NAME"
                                : fmt::format("has no axis \"{}\"", name)}
      .in_file(node.file);
}

}  // namespace

Configuration read_configuration(const Options& options) {
  Node node = config::read_node(options.configuration);
  config::require_runnable(node);
  if (options.node_id) apply_node_id(node, *options.node_id);
  if (options.max_force_N > 0)
    for (Axis& axis : node.axes) lower_force_limit(axis, options.max_force_N);
  Configuration c{.file = node, .node = certified(node), .axes = {}, .odrives = {}, .timed = options.targets.empty()};
  for (std::size_t i = 0; i < node.axes.size(); ++i) {
    const Axis& axis = node.axes[i];
    const double promised_m = std::max(tolerance_m(node, axis), fine_floor_m(c, i));
    c.axes.push_back(unplanned(axis));
    if (axis.drive->odrive) c.odrives.push_back(config::odrive_config<float>(axis));
    // Held is what is within the tolerance and a reading's error of its target, and may read as much further away.
    c.axes.back().reached_m = promised_m + 2 * reading_error_m(axis);
    if (c.timed) plan_times(c.axes.back(), axis);
  }
  plan_tour(c, node, options.targets);
  return c;
}

Configuration read_experiment(const Options& options) {
  if (!options.targets.empty())
    throw InputError{
        "--target: an experiment goes where it has to, and visits no targets; leave it out, or --identify"};
  const Node node = config::read_node(options.configuration);
  Axis axis = axis_to_identify(node, options.axis);
  if (options.node_id && axis.drive) set_node_id(*axis.drive, *options.node_id);
  const config::ExperimentRequest request{
      .duration_s = options.duration_s > 0 ? options.duration_s : config::ExperimentRequest{}.duration_s,
      .max_force_N = options.max_force_N > 0 ? options.max_force_N : config::unlimited};
  ExperimentNode run{.experiment = config::experiment_parameters<float>(node, axis, request)};
  run.loop = config::loop_config(node);
  firmware::FlashedMachineAxis<float>& flashed = run.axes.front();
  std::ranges::copy(axis.name, flashed.name.characters.begin());
  if (!axis.drive->odrive) flashed.drive = config::drive_config<float>(axis);
  flashed.limits = config::axis_limits<float>(axis);
  // It has no target to be near.
  flashed.limits.following_error_m = firmware::AxisLimits<float>::unlimited;
  Configuration c{.file = node, .node = run, .axes = {unplanned(axis)}, .odrives = {}};
  if (axis.drive->odrive) c.odrives.push_back(config::odrive_config<float>(axis));
  c.axes.front().visits.emplace_back();
  return c;
}

}  // namespace breakaway::linux_node
