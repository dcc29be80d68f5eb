#include "breakaway/config/machine_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/read_node.hpp"
#include "breakaway/design/coordinator.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/dense.hpp"
#include "outside_class.hpp"

namespace breakaway::config {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

template <class Value>
VectorXd of_axes(const Node& node, Value value) {
  VectorXd values(static_cast<Index>(node.axes.size()));
  for (Index i = 0; i < values.size(); ++i) values[i] = value(node.axes[static_cast<std::size_t>(i)]);
  return values;
}

double lag_s(const Axis& axis) { return axis.drive->current_loop_time_constant_s; }

// The farthest of each axis' targets from 0, where the springs are at rest.
double farthest_target_m(const Axis& axis) {
  double farthest_m = std::abs(axis.controller.target_m);
  for (const TargetChange& change : axis.controller.targets)
    farthest_m = std::max(farthest_m, std::abs(change.position_m));
  return farthest_m;
}

double room_m(const Axis& axis, double target_m) {
  return std::min(axis.limits.position_max_m - target_m, target_m - axis.limits.position_min_m);
}

// Of its targets.
double nearest_to_a_limit_m(const Axis& axis) {
  double nearest_m = axis.controller.target_m;
  for (const TargetChange& change : axis.controller.targets) {
    if (room_m(axis, change.position_m) < room_m(axis, nearest_m)) nearest_m = change.position_m;
  }
  return nearest_m;
}

// The targets of the file that are not near the one before, or the first one that is not near the home.
std::string too_far_a_target(const Node& node, const Axis& axis) {
  double from_m = axis.controller.target_m;
  if (const Homing& homing = axis.drive->homing; homing.home != cia402::Home::none) {
    const std::string far = way_problem(node, axis, homing.position_m, from_m);
    if (!far.empty()) return fmt::format("axis {}: home and [controller] target_m go {}", axis.name, far);
  }
  for (const TargetChange& change : axis.controller.targets) {
    const std::string far = way_problem(node, axis, from_m, change.position_m);
    if (!far.empty()) return fmt::format("axis {}: [controller] targets go {}", axis.name, far);
    from_m = change.position_m;
  }
  return {};
}

// Of the keys that no certificate of an axis takes in, the machine is what this one is about.
std::string uncertified(const Axis& axis) {
  if (axis.surroundings.encoder_error_m > 0)
    return fmt::format("axis {}: [plant] encoder_error is not known to kicks of several axes; leave it out", axis.name);
  for (const std::string& sentence : axis.surroundings.uncertified) {
    if (!sentence.starts_with("[machine]")) return fmt::format("axis {}: {}", axis.name, sentence);
  }
  return {};
}

// The keys that the law of an axis alone has, and the coordinator has not.
std::string unknown_to_kicks(const Axis& axis) {
  if (feedforward_N(axis) != 0) return "[controller] feedforward_N";
  if (axis.controller.max_approach_speed_m_s < unlimited) return "[controller] max_approach_speed_m_s";
  if (axis.friction.presliding_stiffness_N_per_m > 0) return "[friction] presliding_stiffness_N_per_m";
  if (axis.friction.smooth_slope_Ns_per_m != 0) return "[friction] smooth_slope_Ns_per_m";
  if (axis.move) return "[move]";
  return {};
}

// V is at most start_J on the way, and no mass less than these.
VectorXd approach_speeds_m_s(const stability::CoupledAxes& axes, double start_J) {
  const Eigen::MatrixXd least = axes.mass - Eigen::MatrixXd{axes.mass_error.rowwise().sum().asDiagonal()};
  return (2 * start_J * stability::dense::inverse(least).diagonal()).cwiseAbs().cwiseSqrt();
}

// The supervisor must not stop an axis on its certified way.
std::string too_slow_a_limit(const Node& node, const stability::MachineCertificate& certificate) {
  const VectorXd approach_m_s = approach_speeds_m_s(coupled_axes(node), certificate.sampled.start_J);
  for (std::size_t i = 0; i < certificate.axes.size(); ++i) {
    const double speed_m_s = std::max(approach_m_s[static_cast<Index>(i)], certificate.axes[i].kicked.peak_m_s);
    if (node.axes[i].limits.speed_m_s >= speed_m_s) continue;
    return fmt::format(
        "axis {}: [limits] speed_m_s is {:g}, and approach or kicks may make it {:.4g} m/s fast; raise it",
        node.axes[i].name, node.axes[i].limits.speed_m_s, speed_m_s);
  }
  return {};
}

// Nor on its way past a target: V is at most start_J in the approach, and what the release adds is in the box.
std::string too_near_a_limit(const Node& node, const stability::MachineCertificate& certificate) {
  const stability::SampledApproach approach = sampled_approach(node);
  const Eigen::MatrixXd closed =
      node.coupling->stiffness + Eigen::MatrixXd{approach.position_gain_N_per_m.asDiagonal()};
  const VectorXd reach_m = (2 * certificate.sampled.start_J * stability::dense::inverse(closed).diagonal()).cwiseSqrt();
  for (std::size_t i = 0; i < certificate.axes.size(); ++i) {
    const Axis& axis = node.axes[i];
    const double away_m = std::max(reach_m[static_cast<Index>(i)], certificate.axes[i].box_m);
    if (axis.limits.following_error_m < away_m)
      return fmt::format(
          "axis {}: [limits] following_error_m is {:g}, and an approach may take it {:g} m from its target; raise it "
          "to that, or lower start_m",
          axis.name, axis.limits.following_error_m, rounded_up(away_m, 3));
    const auto target_m = nearest_to_a_limit_m(axis);
    if (room_m(axis, target_m) >= away_m) continue;
    return fmt::format(
        "axis {}: [limits] of position are {:g} m from its target at {:g} m, and an approach may take it {:g} m from "
        "there; widen them, or lower start_m",
        axis.name, room_m(axis, target_m), target_m, rounded_up(away_m, 3));
  }
  return {};
}

// No axis has force before all of them run, so that friction must hold the machine where an approach may begin.
std::string moves_at_start(const Node& node) {
  const stability::CoupledAxes axes = coupled_axes(node);
  const VectorXd pushed_N = axes.load_N + axes.stiffness.cwiseAbs() * sampled_approach(node).start_m;
  for (std::size_t i = 0; i < node.axes.size(); ++i) {
    const double push_N = pushed_N[static_cast<Index>(i)], held_N = node.axes[i].friction.bounds.lower_N;
    if (push_N < held_N) continue;
    return fmt::format(
        "axis {}: springs and loads of [coupling] may push it with {:.4g} N as far as start_m from its target, where "
        "{:g} N of friction are sure to hold it until all axes run; lower start_m or the loads",
        node.axes[i].name, push_N, held_N);
  }
  return {};
}

// What the theorem takes for granted, and the file says otherwise; nothing where it does not.
std::string outside_theorem(const Node& node) {
  if (node.bus_surroundings.loss_probability > 0)
    return "[bus] loss_probability has samples and commands lost, and a certificate needs 0";
  if (node.loop->fault_scope != firmware::FaultScope::all_axes)
    return "[loop] fault_stops must be \"all\": an axis that stops alone leaves the others without it";
  if (node.bus_surroundings.most_delay_s > node.bus_surroundings.least_delay_s)
    return "[bus] delay_max_s is above delay_min_s, so that a kick may be longer than its periods; make them equal";
  for (const Axis& axis : node.axes) {
    if (std::string also = uncertified(axis); !also.empty()) return also;
    if (const std::string late = late_answer(node, axis); !late.empty())
      return fmt::format("axis {}: {}", axis.name, late);
    if (std::string far = too_far_a_target(node, axis); !far.empty()) return far;
    const Uncertainty& u = axis.uncertainty;
    if (lag_s(axis) != lag_s(node.axes.front()))
      return fmt::format(
          "axis {}: [drive] current_loop_time_constant_s is {:g}, and {:g} of axis {}; a hold-off force "
          "comes with the kick only where all are equal",
          axis.name, lag_s(axis), lag_s(node.axes.front()), node.axes.front().name);
    if (u.mass > 0 || u.force_gain > 0 || u.force_N > 0 || u.current_loop_time_constant > 0 || u.jitter_s > 0 ||
        u.encoder_noise_m > 0)
      return fmt::format(
          "axis {}: [uncertainty] is of an axis that moves alone; state mass_error and load_N in "
          "[coupling], and leave it out",
          axis.name);
    if (axis.truth) return fmt::format("axis {}: [told] is of an axis that moves alone; leave it out", axis.name);
    if (const std::string key = unknown_to_kicks(axis); !key.empty())
      return fmt::format("axis {}: {} is not known to kicks of several axes; leave it out", axis.name, key);
  }
  return {};
}

std::string with_names(std::string text, const Node& node) {
  for (std::size_t i = node.axes.size(); i-- > 0;) {
    const std::string number = fmt::format("axis {}", i + 1), name = fmt::format("axis {}", node.axes[i].name);
    for (std::size_t at = text.find(number); at != std::string::npos; at = text.find(number, at + name.size()))
      text.replace(at, number.size(), name);
  }
  return text;
}

}  // namespace

stability::CoupledAxes coupled_axes(const Node& node) {
  const Coupling& c = *node.coupling;
  stability::CoupledAxes a;
  a.mass = c.mass;
  a.mass_error = c.mass_error * c.mass.cwiseAbs();
  if (c.range_m < unlimited) a.range_m = VectorXd::Constant(c.mass.rows(), c.range_m);
  a.mass_slope_kg_per_m = c.mass_slope_kg_per_m;
  a.damping = c.damping;
  a.stiffness = c.stiffness;
  a.load_N = c.load_N + c.stiffness.cwiseAbs() * of_axes(node, farthest_target_m);
  a.friction_lower_N = of_axes(node, [](const Axis& axis) { return axis.friction.bounds.lower_N; });
  a.friction_upper_N = of_axes(node, [](const Axis& axis) { return axis.friction.bounds.upper_N; });
  a.brake_N = VectorXd::Zero(c.mass.rows());
  a.force_step_N = of_axes(node, [](const Axis& axis) { return force_step_N(axis); });
  a.max_force_N = of_axes(node, [](const Axis& axis) { return granted_N(axis, max_force_N(axis)); });
  a.period_s = node.period_s();
  a.lag_s = lag_s(node.axes.front());
  return a;
}

stability::SampledApproach sampled_approach(const Node& node) {
  return {.position_gain_N_per_m =
              of_axes(node, [](const Axis& axis) { return axis.controller.impulsive->stiffness_N_per_m; }),
          .velocity_gain_Ns_per_m =
              of_axes(node, [](const Axis& axis) { return axis.controller.impulsive->approach_damping_Ns_per_m; }),
          .start_m = VectorXd::Constant(node.coupling->mass.rows(), node.coupling->start_m),
          .resolution_m = of_axes(node, [](const Axis& axis) { return axis.drive->encoder_resolution_m; }),
          .latency_periods = node.axes.front().latency_periods};
}

VectorXd tolerances_m(const Node& node) {
  return of_axes(node, [&](const Axis& axis) { return tolerance_m(node, axis); });
}

stability::MachineCertificate examine_machine(const Node& node) try {
  require_fitting_bus(node);
  stability::MachineCertificate certificate =
      stability::certify_machine(coupled_axes(node), sampled_approach(node), tolerances_m(node));
  std::string outside = outside_theorem(node);
  if (outside.empty()) outside = moves_at_start(node);
  if (outside.empty() && certificate.certified) outside = too_slow_a_limit(node, certificate);
  if (outside.empty() && certificate.certified) outside = too_near_a_limit(node, certificate);
  if (!outside.empty()) {
    certificate.certified = false;
    certificate.reason = outside;
  }
  certificate.reason = with_names(certificate.reason, node);
  for (stability::Condition& condition : certificate.conditions) {
    condition.name = with_names(condition.name, node);
    condition.reason = with_names(condition.reason, node);
  }
  return certificate;
} catch (const InputError& error) {
  throw error.file().empty() ? error.in_file(node.file) : error;
}

std::string machine_promise(const Node& node, const stability::MachineCertificate& certificate) {
  return fmt::format(
      "from rest within {:.4g} m of its targets it approaches them, is let go, and reaches them after {} kicks at "
      "most, of one axis after another; no kick moves another axis, and none goes beyond",
      node.coupling->start_m, certificate.most_kicks);
}

std::vector<std::string> machine_conditions(const Node& node) {
  std::vector<std::string> conditions;
  for (const Axis& axis : node.axes)
    conditions.push_back(
        fmt::format("the friction of axis {} stays between {:g} N and {:g} N at any position, speed and time, as it "
                    "likes",
                    axis.name, axis.friction.bounds.lower_N, axis.friction.bounds.upper_N));
  const Coupling& c = *node.coupling;
  conditions.push_back(fmt::format("every mass of [coupling] is within {:g} % of what is told{}", 100 * c.mass_error,
                                   c.range_m < unlimited ? fmt::format(", {:g} m around the targets", c.range_m) : ""));
  conditions.push_back("springs, dampers and loads are those of [coupling], and the mechanism is rigid but for them");
  conditions.push_back(fmt::format("each target is given at rest, {:g} m away at most", c.start_m));
  conditions.emplace_back("a target is a whole count, to which the loop rounds every other");
  conditions.push_back(
      fmt::format("every drive gives the force that is commanded, in whole periods, behind a current "
                  "loop of {:g} s, all at one instant",
                  lag_s(node.axes.front())));
  conditions.push_back("a reading is off by half a count at most, and no sample or command is lost");
  return conditions;
}

template <class Real>
MachineNode<Real> flashed_machine(const Node& node, const stability::MachineCertificate& certificate) {
  require_flashable(node);
  if (!certificate.certified)
    throw InputError{"the machine of its axes is not certified, and its kicks are made from the certificate: " +
                     certificate.reason}
        .in_file(node.file);
  MachineNode<Real> flashed{.loop = loop_config(node),
                            .wiring = node.wiring,
                            .count = static_cast<std::uint8_t>(node.axes.size()),
                            .axes = {},
                            .coordinator = design::coordinator_parameters<Real, most_axes>(
                                coupled_axes(node), sampled_approach(node), tolerances_m(node), certificate),
                            .certified = true};
  for (std::size_t i = 0; i < node.axes.size(); ++i) {
    const Axis& axis = node.axes[i];
    flashed.axes[i] = {.name = {}, .drive = drive_config<Real>(axis), .limits = axis_limits<Real>(axis)};
    std::ranges::copy(axis.name, flashed.axes[i].name.characters.begin());
  }
  flashed.checksum = checksum_of(flashed);
  return flashed;
}

template MachineNode<float> flashed_machine(const Node&, const stability::MachineCertificate&);
template MachineNode<double> flashed_machine(const Node&, const stability::MachineCertificate&);

MachineNode<float> certified_machine(const Node& node, const stability::MachineCertificate& certificate) {
  const auto flashed = flashed_machine<float>(node, certificate);
  if (const firmware::NodeVerdict verdict = firmware::verify(flashed); !verdict.ok())
    throw InputError{fmt::format("axis {}, in float: {}", node.axes[verdict.axis].name, to_string(verdict.error))}
        .in_file(node.file);
  return flashed;
}

}  // namespace breakaway::config
