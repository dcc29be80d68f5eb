#include "breakaway/config/axis_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace breakaway::config {

namespace {

std::optional<design::MoveRequest> move_request(const Axis& axis) {
  if (!axis.move) return {};
  return design::MoveRequest{axis.move->distance_m,
                             std::min(axis.move->speed_m_s, axis.controller.max_approach_speed_m_s),
                             axis.move->acceleration_m_s2, axis.move->jerk_m_s3};
}

// Of the mass that is told, which may be off from the truth, each side has the share that is stated. Friction that
// drifts leaves its bounds on either side.
std::optional<design::SpringLoad> spring_load(const Axis& axis) {
  std::optional<design::SpringLoad> load = axis.surroundings.load;
  if (!load || !(load->load_friction.lower_N > 0)) return {};  // the second is refused
  const double told = axis.mass_kg / mass_of_all_kg(axis), drift = axis.surroundings.drift;
  const auto drifting = [&](const law::FrictionBounds<double>& f) {
    return law::FrictionBounds<double>{f.lower_N * (1 - drift), f.upper_N * (1 + drift)};
  };
  load->motor_kg = told * truth_of(axis).mass_kg;
  load->load_kg *= told;
  load->motor_friction = drifting(truth_of(axis).bounds);
  load->load_friction = drifting(load->load_friction);
  load->gap_m = axis.surroundings.gap_m;
  return load;
}

// The supervisor stops an axis beyond its speed limit. A move has a margin of its own; any other approach goes as fast
// as its force allows, or its spring under the coast "pd", and faster than it is read by where samples come late.
double approach_speed_m_s(const Node& node, const Axis& axis) {
  constexpr double share_of_limit = 0.9;
  const double asked_m_s = axis.controller.max_approach_speed_m_s;
  if (axis.move || !(axis.limits.speed_m_s < unlimited)) return asked_m_s;
  const double late = node.loop ? axis.uncertainty.jitter_s / node.period_s() : 0;
  return std::min(asked_m_s, share_of_limit * axis.limits.speed_m_s / (1 + late));
}

double flicker_m(const Axis& axis) {
  if (!axis.drive) return 2 * axis.uncertainty.encoder_noise_m;
  return design::flicker_m(axis.uncertainty.encoder_noise_m, rounding_m(axis), axis.drive->encoder_resolution_m);
}

}  // namespace

// Where a target torque counts in the largest torque, the set-up lowers that to the limit of the axis, cut down to
// whole per mille of the rated torque: no more is given.
double max_force_N(const Axis& axis) {
  const double given_N = axis.drive ? axis.drive->max_force_N() : unlimited;
  const double most_N = std::min(axis.controller.max_force_N, given_N);
  if (!axis.drive || axis.drive->torque_base == cia402::TorqueBase::rated) return most_N;
  const double quantum_N = axis.drive->force_quantum_N();
  return quantum_N * std::floor(most_N / quantum_N * (1 + 1e-6));
}

double force_step_N(const Axis& axis) {
  const double quantum_N = axis.drive->force_quantum_N();
  if (axis.drive->torque_base == cia402::TorqueBase::rated) return quantum_N;
  return std::max(max_force_N(axis), quantum_N) / 1000;
}

double granted_N(const Axis& axis, double force_N) {
  if (!axis.drive || !(force_N < unlimited)) return force_N;
  const double step_N = force_step_N(axis), steps = force_N / step_N;
  return std::abs(steps - std::round(steps)) < 1e-6 ? force_N : std::floor(steps) * step_N;
}

double feedforward_N(const Axis& axis) {
  if (!axis.controller.impulsive || !axis.drive) return 0;
  const double step_N = force_step_N(axis);
  return std::round(axis.controller.impulsive->feedforward_N / step_N) * step_N;
}

double answer_delay_s(const Node& node, const Axis& axis) {
  return 2 * node.bus_surroundings.least_delay_s + axis.surroundings.feedback_delay_s;
}

OffCount furthest_off_count(const Axis& axis) {
  const double count_m = axis.drive ? axis.drive->encoder_resolution_m : 0;
  OffCount furthest{0, 0};
  const auto look_at = [&](double target_m) {
    const OffCount here{target_m, std::round(target_m / count_m) * count_m};
    if (here.m() > std::max(furthest.m(), 1e-6 * count_m)) furthest = here;
  };
  if (!(count_m > 0)) return furthest;
  look_at(axis.controller.target_m);
  for (const TargetChange& change : axis.controller.targets) look_at(change.position_m);
  return furthest;
}

double law_force_N(const Axis& axis) { return max_force_N(axis) - std::abs(feedforward_N(axis)); }

template <class Real>
law::AxisParameters<Real> axis_parameters(const Node& node, const Axis& axis) {
  const ImpulsiveGains& gains = *axis.controller.impulsive;
  law::AxisParameters<Real> p;
  p.mass_kg = static_cast<Real>(axis.mass_kg);
  p.stiffness_N_per_m = static_cast<Real>(gains.stiffness_N_per_m);
  p.approach_damping_Ns_per_m = static_cast<Real>(gains.approach_damping_Ns_per_m);
  p.kick_damping_Ns_per_m = static_cast<Real>(gains.kick_damping_Ns_per_m);
  p.friction = {static_cast<Real>(axis.friction.bounds.lower_N), static_cast<Real>(axis.friction.bounds.upper_N)};
  p.max_force_N = static_cast<Real>(law_force_N(axis));
  p.feedforward_N = static_cast<Real>(feedforward_N(axis));
  // Their sum is rounded, too, and must not come to be more than there is.
  while (p.total_force_N() > static_cast<Real>(max_force_N(axis)))
    p.max_force_N = std::nextafter(p.max_force_N, Real{0});
  p.max_approach_speed_m_s = static_cast<Real>(approach_speed_m_s(node, axis));
  p.position_tolerance_m = static_cast<Real>(tolerance_m(node, axis));
  p.encoder_resolution_m = static_cast<Real>(axis.drive ? axis.drive->encoder_resolution_m : 0.0);
  p.flicker_m = static_cast<Real>(flicker_m(axis));
  p.period_s = static_cast<Real>(node.period_s());
  p.latency_periods = axis.latency_periods;
  p.coast = gains.coast;
  return p;
}

design::BrakedClass braked_class(const Node& node, const Axis& axis) {
  const Uncertainty& u = axis.uncertainty;
  const auto either_way = [](double value, double share) {
    return design::Interval{value * (1 - share), value * (1 + share)};
  };
  return {.mass_kg = either_way(axis.mass_kg, u.mass),
          .force_gain = either_way(1, u.force_gain),
          .lag_s = either_way(axis.drive->current_loop_time_constant_s, u.current_loop_time_constant),
          .friction = axis.friction.bounds,
          .load_N = u.force_N,
          .max_force_N = law_force_N(axis),
          .force_step_N = force_step_N(axis),
          .period_s = node.period_s(),
          .jitter_s = u.jitter_s,
          .encoder_resolution_m = axis.drive->encoder_resolution_m,
          .encoder_noise_m = u.encoder_noise_m,
          .rounding_m = rounding_m(axis),
          .latency_periods = axis.latency_periods,
          .presliding_stiffness_N_per_m = axis.friction.presliding_stiffness_N_per_m,
          .fine_tolerance_m = axis.controller.impulsive->fine_stage ? tolerance_m(node, axis) : 0,
          .move = move_request(axis),
          .spring_load = spring_load(axis)};
}

double mass_of_all_kg(const Axis& axis) {
  const auto& load = axis.surroundings.load;
  return truth_of(axis).mass_kg + (load ? load->load_kg : 0);
}

law::FrictionBounds<double> friction_of_all(const Axis& axis) {
  const auto& load = axis.surroundings.load;
  const law::FrictionBounds<double> motor = truth_of(axis).bounds;
  if (!load) return motor;
  return {motor.lower_N + load->load_friction.lower_N, motor.upper_N + load->load_friction.upper_N};
}

template <class Real>
law::PidParameters<Real> pid_parameters(const Node& node, const Axis& axis) {
  const PidGains& gains = *axis.controller.pid;
  law::PidParameters<Real> p;
  p.proportional_N_per_m = static_cast<Real>(gains.proportional_N_per_m);
  p.integral_N_per_ms = static_cast<Real>(gains.integral_N_per_ms);
  p.derivative_Ns_per_m = static_cast<Real>(gains.derivative_Ns_per_m);
  p.max_force_N = static_cast<Real>(max_force_N(axis));
  p.max_approach_speed_m_s = static_cast<Real>(axis.controller.max_approach_speed_m_s);
  p.encoder_resolution_m = static_cast<Real>(axis.drive->encoder_resolution_m);
  p.friction_lower_N = static_cast<Real>(axis.friction.bounds.lower_N);
  p.period_s = static_cast<Real>(node.period_s());
  return p;
}

double counted_m(const Axis& axis) { return axis.drive ? 0x1p31 * axis.drive->encoder_resolution_m : unlimited; }

bool is_counted(double distance_m, const Axis& axis) {
  return !axis.drive || std::abs(std::round(distance_m / axis.drive->encoder_resolution_m)) < 0x1p31;
}

std::string target_problem(double position_m, const Axis& axis) {
  const Limits& l = axis.limits;
  if (position_m < l.position_min_m || position_m > l.position_max_m)
    return fmt::format("is beyond its [limits], position_m = {:.10g} to {:.10g}; choose one inside", l.position_min_m,
                       l.position_max_m);
  if (!is_counted(position_m, axis)) return "is beyond the encoder's range; choose one inside";
  return {};
}

std::string way_problem(const Node& node, const Axis& axis, double from_m, double to_m) {
  if (!node.coupling) return {};
  const double start_m = node.coupling->start_m;
  if (std::abs(to_m - from_m) <= start_m + axis.drive->encoder_resolution_m) return {};
  return fmt::format(
      "from {:g} m to {:g} m at once, and [coupling] start_m is {:g}; name places between, or raise start_m", from_m,
      to_m, start_m);
}

template law::AxisParameters<float> axis_parameters(const Node&, const Axis&);
template law::AxisParameters<double> axis_parameters(const Node&, const Axis&);
template law::PidParameters<float> pid_parameters(const Node&, const Axis&);
template law::PidParameters<double> pid_parameters(const Node&, const Axis&);

}  // namespace breakaway::config
