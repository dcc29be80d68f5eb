// A load on a belt under the coast "work", for the tests of that law's parts.
#pragma once

#include <cmath>
#include <numbers>

#include "../../two_mass_axis.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::law::work_test {

// 1 kg, two fifths of it the motor's, 2.5 to 4.5 N, that swings 50 times a second.
inline design::BrakedClass belt() {
  design::BrakedClass c = breakaway::testing::axes_of_the_scenes(0);
  design::SpringLoad load{.motor_kg = 0.4,
                          .load_kg = 0.6,
                          .stiffness_N_per_m = 0.24 * std::pow(2 * std::numbers::pi * 50, 2),
                          .motor_friction = {1.25, 2.25},
                          .load_friction = {1.25, 2.25}};
  c.spring_load = load;
  return c;
}

template <class Real>
AxisParameters<Real> parameters_of(const design::BrakedClass& c, double tolerance_m) {
  AxisParameters<Real> p;
  p.mass_kg = 1;
  p.stiffness_N_per_m = 100;
  p.approach_damping_Ns_per_m = 15;
  p.kick_damping_Ns_per_m = 25;
  p.friction = {static_cast<Real>(c.friction.lower_N), static_cast<Real>(c.friction.upper_N)};
  p.max_force_N = static_cast<Real>(c.max_force_N);
  p.max_approach_speed_m_s = 10;
  p.position_tolerance_m = static_cast<Real>(tolerance_m);
  p.encoder_resolution_m = static_cast<Real>(c.encoder_resolution_m);
  p.period_s = static_cast<Real>(c.period_s);
  p.coast = Coast::work;
  return p;
}

}  // namespace breakaway::law::work_test
