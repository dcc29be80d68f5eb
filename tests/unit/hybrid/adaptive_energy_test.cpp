// The energy of machines under friction laws, as the adaptive method moves them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "adaptive_machines.hpp"

namespace breakaway::hybrid::adaptive_energy_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The work of all friction and damping, by the trapezoidal rule over short steps, is the energy that is lost.
TEST(Adaptive, KeepsTheBalanceOfEnergy) {
  const auto machine = stribeck_machine();
  const auto laws = stribeck_laws();
  const Adaptive adaptive(machine, laws, {.longest_step_s = 1e-3});
  const auto power_W = [&](const State& state) {
    double power = state.v.dot(machine.damping * state.v);
    for (Eigen::Index i = 0; i < 2; ++i) {
      power += laws[static_cast<std::size_t>(i)].level_N(state.time_s, state.q[i], std::abs(state.v[i])) *
               std::abs(state.v[i]);
    }
    return power;
  };
  double lost_J = 0, energy_J = stability::energy_J(machine, stribeck_start());
  State before = stribeck_start();
  const double start_J = energy_J;
  const auto outcome = adaptive.run(before, 12, nullptr, [&](const State& state) {
    lost_J += (state.time_s - before.time_s) * (power_W(before) + power_W(state)) / 2;
    before = state;
    energy_J = stability::energy_J(machine, state);
    // The trapezoidal rule errs by h^2 / 12 times the change of the power's slope, which friction makes jump.
    EXPECT_NEAR(energy_J + lost_J, start_J, 1e-5);
  });
  EXPECT_GT(lost_J, 0.5 * start_J);
  EXPECT_GT(outcome.events, 5U);
}

model::ShapePtr random_shape(std::mt19937& random) {
  const auto number = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  };
  std::vector<model::ShapePtr> parts;
  switch (std::uniform_int_distribution<int>(0, 8)(random)) {
    case 0:
      return model::shape::static_kinetic(number(0.5, 1), number(0, 0.5));
    case 1:
      return model::shape::stribeck(number(0.05, 1));
    case 2:
      return model::shape::stribeck_gaussian(number(0.05, 1));
    case 3:
      return model::shape::sine_in_time(number(0.5, 8), number(0, 6));
    case 4:
      return model::shape::sine_in_position(number(0.1, 2), number(0, 6));
    case 5:
      return model::shape::position_table({number(-2, 0), number(0.1, 2)}, {number(0, 1), number(0, 1), number(0, 1)});
    case 6:
      return model::shape::random_dwell(
          {.seed = random(), .shortest_dwell_s = 0.1, .longest_dwell_s = 1, .bound_share = 0.2});
    case 7:
      return model::shape::constant(number(0, 1));
    default:
      parts.push_back(model::shape::stribeck(number(0.05, 1)));
      parts.push_back(model::shape::position_table({0}, {number(0, 1), number(0, 1)}));
      return model::shape::product(std::move(parts));
  }
}

// Any law, dependent directions and more of them than coordinates included: V of (5) never rises under damping >= 0
// by more than the steps err.
TEST(Adaptive, EnergyNeverRisesInRandomMachines) {
  std::mt19937 random(20261121);
  std::uniform_real_distribution<double> entry(-1, 1);
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return entry(random); }));
  };
  std::uint64_t events = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto n = std::uniform_int_distribution<Eigen::Index>(1, 4)(random);
    const auto m = std::uniform_int_distribution<Eigen::Index>(0, 5)(random);
    const auto square = [&] {
      const MatrixXd root = matrix(n, n);
      return MatrixXd(root * root.transpose() + 0.1 * MatrixXd::Identity(n, n));
    };
    LinearMachine<> machine;
    machine.mass = square();
    machine.damping = 0.1 * square();
    machine.stiffness = square();
    machine.directions = matrix(n, m);
    if (m > 1 && trial % 3 == 0) machine.directions.col(1) = -machine.directions.col(0);
    machine.friction_N = VectorXd::Zero(m);
    Adaptive::Laws laws;
    for (Eigen::Index i = 0; i < m; ++i) {
      const double lower_N = 0.05 + 0.2 * std::abs(entry(random));
      laws.push_back({model::FrictionBounds{lower_N, lower_N + 0.3}, random_shape(random)});
    }
    const State start{0, matrix(n, 1), trial % 4 == 0 ? MatrixXd(VectorXd::Zero(n)) : matrix(n, 1)};
    double energy_J = stability::energy_J(machine, start);
    const double rounding_J = 1e-11 * energy_J;
    const auto outcome = Adaptive(machine, laws).run(start, 15, nullptr, [&](const State& state) {
      const double now_J = stability::energy_J(machine, state);
      EXPECT_LE(now_J, energy_J + rounding_J) << "trial " << trial << " at " << state.time_s;
      energy_J = now_J;
    });
    events += outcome.events;
  }
  EXPECT_GT(events, 1000U);
}

}  // namespace
}  // namespace breakaway::hybrid::adaptive_energy_test
