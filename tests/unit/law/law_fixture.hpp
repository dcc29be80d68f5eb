// An axis to test the law with: the paper's mass and friction bounds, gains that suit a 1 kHz loop.
#pragma once

#include <gtest/gtest.h>
#include <array>

#include <cmath>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/control_types.hpp"
#include "breakaway/law/k3_table.hpp"

namespace breakaway::law::testing {

template <class Scalar>
AxisParameters<Scalar> sampled_axis() {
  AxisParameters<Scalar> p;
  p.mass_kg = 1;
  p.stiffness_N_per_m = 400;
  p.approach_damping_Ns_per_m = 32;
  p.kick_damping_Ns_per_m = 60;
  p.friction.lower_N = Scalar(2.5);
  p.friction.upper_N = Scalar(4.5);
  p.max_force_N = 50;
  p.max_approach_speed_m_s = 5;
  p.position_tolerance_m = Scalar(1.8e-6);
  p.encoder_resolution_m = Scalar(1e-6);
  p.period_s = Scalar(1e-3);
  return p;
}

// Without feedback the k3 curve is a parabola, R = m sqrt(2 f_lo / m), and every kick has a closed form.
// The period in which a fault is named is one of it already.
template <class Controller, class Scalar>
void expect_nothing_with_a_fault(const Controller& controller, const ControlOutput<Scalar>& out) {
  if (controller.fault() == ControlFault::none) return;
  EXPECT_EQ(out.mode, Mode::fault);
  EXPECT_EQ(out.force_N, 0);
  EXPECT_EQ(out.impulse_Ns, 0);
  EXPECT_FALSE(out.kicked);
}

template <class Scalar>
K3Table<Scalar> ballistic_table(const AxisParameters<Scalar>& p, Scalar largest_m) {
  K3Table<Scalar> table;
  table.root_max = std::sqrt(largest_m);
  table.nodes_per_root = static_cast<Scalar>(table.nodes.size() - 1) / table.root_max;
  table.nodes.fill({std::sqrt(2 * p.friction.lower_N * p.mass_kg), Scalar{0}});
  return table;
}

}  // namespace breakaway::law::testing
