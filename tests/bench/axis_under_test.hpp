// The axis that all figures are for: sim/scenarios/can_axis.toml, from rest.
#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/cia402/drive.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/pid_controller.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::bench {

// At the shortest whole number of milliseconds in which so many axes fit the bus.
inline scenario::Scenario axis_scenario(std::size_t axes = 1) {
  scenario::Scenario s = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/can_axis.toml");
  s.plant.velocity_m_s = 0;
  auto period = std::chrono::milliseconds{1};
  while (canopen::check_bus_budget(static_cast<unsigned>(axes), period, s.bus->bit_rate) != canopen::BusFit::fits) {
    if (++period > std::chrono::seconds{1}) throw std::runtime_error("the axes do not fit the bus of can_axis.toml");
  }
  s.loop->period_s = hal::seconds(period);
  return s;
}

inline design::KickPlant<double> kick_plant(const scenario::Scenario& s) {
  return {s.plant.mass_kg, s.controller.impulsive->stiffness_N_per_m, s.controller.impulsive->kick_damping_Ns_per_m,
          s.friction.lower_N};
}

template <class Real>
design::BuiltK3Table<Real> build_table(const scenario::Scenario& s) {
  const double range_m = static_cast<double>(scenario::axis_parameters<Real>(s).stick_radius_upper_m());
  return design::build_k3_table<Real>(kick_plant(s), range_m);
}

// Gains of the switching law's approach and an integrator beside them: what is compared is the work, not the result.
template <class Real>
law::PidController<Real> pid_controller(const scenario::Scenario& s) {
  const law::AxisParameters<Real> p = scenario::axis_parameters<Real>(s);
  law::PidParameters<Real> pid;
  pid.proportional_N_per_m = p.stiffness_N_per_m;
  pid.integral_N_per_ms = 5 * p.stiffness_N_per_m;
  pid.derivative_Ns_per_m = p.approach_damping_Ns_per_m;
  pid.max_force_N = p.max_force_N;
  pid.max_approach_speed_m_s = p.max_approach_speed_m_s;
  pid.encoder_resolution_m = p.encoder_resolution_m;
  pid.friction_lower_N = p.friction.lower_N;
  pid.period_s = p.period_s;
  return law::PidController<Real>{pid};
}

inline hal::Duration period_of(const scenario::Scenario& s) {
  return hal::Duration{std::llround(s.loop->period_s * 1e9)};
}

template <class Real>
cia402::DriveConfig<Real> drive_config(const scenario::Scenario& s, std::uint8_t node_id) {
  cia402::DriveConfig<Real> c;
  c.node_id = node_id;
  c.force_per_torque_N_per_Nm = static_cast<Real>(s.drive->force_per_torque_N_per_Nm);
  return c;
}

inline canopen::NetworkConfig network_config(const scenario::Scenario& s) {
  return {.period = period_of(s), .bit_rate = s.bus->bit_rate};
}

template <class Real>
hal::AxisScale<Real> axis_scale(const scenario::Scenario& s) {
  return {static_cast<Real>(s.drive->encoder_resolution_m), static_cast<Real>(s.controller.max_force_N)};
}

template <class Real>
firmware::AxisLimits<Real> limits(const scenario::Scenario& s) {
  firmware::AxisLimits<Real> l;
  l.position_min_m = static_cast<Real>(-s.limits.position_m);
  l.position_max_m = static_cast<Real>(s.limits.position_m);
  l.speed_m_s = static_cast<Real>(s.limits.speed_m_s);
  l.feedback_timeout = 5 * period_of(s) / 2;
  return l;
}

}  // namespace breakaway::bench
