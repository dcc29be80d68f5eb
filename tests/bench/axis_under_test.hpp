// The axis that all figures are for where nothing else is said: sim/scenarios/can_axis.toml, from rest.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/config/axis_parameters.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/design/k3_table_builder.hpp"
#include "breakaway/design/pd_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"
#include "breakaway/law/pid_controller.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::bench {

// sim/scenarios/<name>.toml, of one axis or more, the first from rest.
inline scenario::Scenario scenario_from_rest(const std::string& name) {
  scenario::Scenario s = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/" + name + ".toml");
  s.worlds[0].velocity_m_s = 0;
  return s;
}

// So many of it on one bus, at the shortest whole number of milliseconds in which they fit.
inline scenario::Scenario axis_scenario(std::size_t axes = 1) {
  scenario::Scenario s = scenario_from_rest("can_axis");
  for (std::size_t i = 1; i < axes; ++i) {
    s.node.axes.push_back(s.node.axes[0]);
    s.worlds.push_back(s.worlds[0]);
    const auto node_id = static_cast<std::uint8_t>(i + 1);
    s.node.axes[i].name += std::to_string(i);
    s.node.axes[i].drive->node_id = s.worlds[i].drive->node_id = node_id;
  }
  auto period = std::chrono::milliseconds{1};
  while (canopen::check_bus_budget(static_cast<unsigned>(axes), period, *s.node.bit_rate) != canopen::BusFit::fits) {
    if (++period > std::chrono::seconds{1}) throw std::runtime_error("the axes do not fit the bus of can_axis.toml");
  }
  s.node.loop->period = period;
  return s;
}

template <class Real>
law::AxisParameters<Real> parameters(const scenario::Scenario& s) {
  return config::axis_parameters<Real>(s.node, s.node.axes[0]);
}

inline design::KickPlant<double> kick_plant(const scenario::Scenario& s) {
  const config::Axis& axis = s.node.axes[0];
  return {axis.mass_kg, axis.controller.impulsive->stiffness_N_per_m, axis.controller.impulsive->kick_damping_Ns_per_m,
          axis.friction.bounds.lower_N};
}

template <class Real>
law::KickTable<Real> build_pulses(const scenario::Scenario& s) {
  return design::design_pd_kicks(parameters<Real>(s), s.node.axes[0].drive->current_loop_time_constant_s).table;
}

template <class Real>
design::BuiltK3Table<Real> build_table(const scenario::Scenario& s) {
  return design::build_k3_table<Real>(kick_plant(s), static_cast<double>(parameters<Real>(s).stick_radius_upper_m()));
}

// Gains of the switching law's approach and an integrator beside them: what is compared is the work, not the result.
template <class Real>
law::PidController<Real> pid_controller(const scenario::Scenario& s) {
  const law::AxisParameters<Real> p = parameters<Real>(s);
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

inline double resolution_m(const scenario::Scenario& s) { return s.node.axes[0].drive->encoder_resolution_m; }

}  // namespace breakaway::bench
