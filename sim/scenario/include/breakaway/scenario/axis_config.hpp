// What the control loop is told of a scene's axis: its drive and its limits.
#pragma once

#include <chrono>
#include <cmath>

#include "breakaway/cia402/drive.hpp"
#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

inline hal::Duration nanoseconds(double seconds) { return hal::Duration{std::llround(seconds * 1e9)}; }

// Require s.loop, s.drive and s.bus.

template <class Real>
cia402::DriveConfig<Real> drive_config(const Scenario& s) {
  cia402::DriveConfig<Real> c;
  c.node_id = s.drive->node_id;
  c.force_per_torque_N_per_Nm = static_cast<Real>(s.drive->force_per_torque_N_per_Nm);
  return c;
}

inline canopen::NetworkConfig network_config(const Scenario& s) {
  return {.period = nanoseconds(s.loop->period_s), .bit_rate = s.bus->bit_rate};
}

template <class Real>
hal::AxisScale<Real> axis_scale(const Scenario& s) {
  return {static_cast<Real>(s.drive->encoder_resolution_m), static_cast<Real>(s.controller.max_force_N)};
}

template <class Real>
firmware::AxisLimits<Real> axis_limits(const Scenario& s) {
  firmware::AxisLimits<Real> l;
  l.position_min_m = static_cast<Real>(-s.limits.position_m);
  l.position_max_m = static_cast<Real>(s.limits.position_m);
  l.speed_m_s = static_cast<Real>(s.limits.speed_m_s);
  l.following_error_m = static_cast<Real>(s.limits.following_error_m);
  l.feedback_timeout = nanoseconds(2.5 * s.loop->period_s);  // two samples lost in a row stop the axis
  return l;
}

}  // namespace breakaway::scenario
