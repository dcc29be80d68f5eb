// Machines that are drawn, and what Gauss' principle of least constraint on numbers of 113 bits says of them, which
// shares nothing with what is tested: for tests of what sticks and what slips next.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../../campaign/friction_decision.hpp"
#include "breakaway/hybrid/hybrid_modes.hpp"

namespace {

using breakaway::hybrid::contains;
using breakaway::hybrid::DirectionSet;
using breakaway::hybrid::HybridModes;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::only;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Modes = HybridModes<>;
using State = Modes::State;
namespace campaign = breakaway::campaign;
using campaign::Quad;

inline double between(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 8) / 0x1p24;
}
inline int whole(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}
inline MatrixXd drawn(std::mt19937& random, Index rows, Index columns, double size) {
  MatrixXd result(rows, columns);
  for (double& x : result.reshaped()) x = between(random, -size, size);
  return result;
}
inline MatrixXd drawn_mass(std::mt19937& random, Index size) {
  const MatrixXd factor = drawn(random, size, size, 1);
  return factor * factor.transpose() + 0.3 * MatrixXd::Identity(size, size);
}

inline campaign::Matrix<Quad> quad(const MatrixXd& from) {
  campaign::Matrix<Quad> result(static_cast<std::size_t>(from.rows()), static_cast<std::size_t>(from.cols()));
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j)
      result(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = Quad(from(i, j));
  }
  return result;
}

// The signs that Gauss' principle gives to the `stopped` directions.
inline std::vector<int> truth(const LinearMachine<>& machine, const State& state, DirectionSet stopped) {
  const campaign::Matrix<Quad> mass = quad(machine.mass), factor = campaign::inverse_cholesky_factor(mass);
  const campaign::Matrix<Quad> back = factor.transposed();
  campaign::NormalMachine<Quad> normal;
  normal.stiffness = factor * quad(machine.stiffness) * back;
  normal.damping = factor * quad(machine.damping) * back;
  normal.force = factor * quad(machine.force_N).column(0);
  const campaign::Matrix<Quad> directions = factor * quad(machine.directions);
  std::vector<bool> stops;
  std::vector<int> signs;
  for (Index i = 0; i < machine.frictions(); ++i) {
    campaign::Vector<Quad> push = directions.column(static_cast<std::size_t>(i));
    for (Quad& x : push) x *= Quad(machine.friction_N[i]);
    normal.pushes.push_back(push);
    stops.push_back(contains(stopped, i));
    signs.push_back(static_cast<int>(state.signs[i]));
  }
  normal.rate = campaign::square_root(normal.stiffness.row_norm()) + normal.damping.row_norm();
  const auto q = factor * (mass * quad(state.q).column(0)), v = factor * (mass * quad(state.v).column(0));
  EXPECT_TRUE(campaign::decide_friction(normal, q, v, stops, signs));
  return signs;
}

inline std::vector<int> signs_of(const State& state) { return {state.signs.begin(), state.signs.end()}; }

// What sticks has no sign, and everything else has one.
inline void expect_signs(const State& state, const std::vector<int>& signs, const std::string& what) {
  EXPECT_EQ(signs_of(state), signs) << what;
  for (Index i = 0; i < state.signs.size(); ++i) EXPECT_EQ(contains(state.sticking, i), state.signs[i] == 0) << what;
}

inline DirectionSet all_of(const LinearMachine<>& machine) { return only(machine.frictions()) - 1; }

inline LinearMachine<> drawn_machine(std::mt19937& random, Index coordinates, Index directions) {
  LinearMachine<> machine;
  machine.mass = drawn_mass(random, coordinates);
  machine.damping = drawn(random, coordinates, coordinates, 1);
  machine.stiffness = drawn(random, coordinates, coordinates, 2);
  machine.directions = drawn(random, coordinates, directions, 1);
  machine.friction_N = drawn(random, directions, 1, 0.9).array() + 1;
  machine.force_N = drawn(random, coordinates, 1, 3);
  return machine;
}

inline State at_rest(const LinearMachine<>& machine) {
  State state;
  state.q = state.v = VectorXd::Zero(machine.coordinates());
  state.signs = VectorXd::Zero(machine.frictions());
  return state;
}

// A velocity with which these directions stand, and the signs of the others. Dependent directions stand with them.
inline DirectionSet move(std::mt19937& random, const LinearMachine<>& machine, DirectionSet stand, State& state) {
  std::vector<Index> standing;
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (contains(stand, i)) standing.push_back(i);
  }
  state.v = drawn(random, machine.coordinates(), 1, 1);
  if (!standing.empty()) {
    const MatrixXd held = machine.directions(Eigen::all, standing).transpose();
    const VectorXd of_held = held.completeOrthogonalDecomposition().solve(VectorXd{held * state.v});
    state.v -= of_held;
  }
  for (Index i = 0; i < machine.frictions(); ++i) {
    const double speed = machine.directions.col(i).dot(state.v);
    if (std::abs(speed) < 1e-12) stand |= only(i);
    state.signs[i] = contains(stand, i) ? 0 : speed > 0 ? 1 : -1;
  }
  return stand;
}

struct Met {
  int stick = 0, slide = 0, mixed = 0;
  void add(const State& state, DirectionSet stopped) {
    const DirectionSet slid = stopped & ~state.sticking;
    ++(slid == 0 ? stick : slid == stopped ? slide : mixed);
  }
};

// Forces of friction of which some are at their limits, and a coordinate without friction that changes the load on all
// of them through springs: its velocity says which of them give way.
struct AtLimits {
  LinearMachine<> machine;
  State state;
  VectorXd bears;
  std::vector<Index> at_limit;
};
inline AtLimits at_limits(std::mt19937& random, Index rubbing, Index directions, double apart = 0) {
  AtLimits result;
  const Index n = rubbing + 1;
  LinearMachine<>& machine = result.machine;
  machine.mass = MatrixXd::Identity(n, n);
  machine.mass.topLeftCorner(rubbing, rubbing) = drawn_mass(random, rubbing);
  machine.damping = MatrixXd::Zero(n, n);
  for (double& x : machine.damping.reshaped()) x = 0.125 * whole(random, -8, 8);
  machine.stiffness = 3 * MatrixXd::Identity(n, n);
  machine.stiffness.topRightCorner(rubbing, 1) = drawn(random, rubbing, 1, 1);
  machine.stiffness.bottomLeftCorner(1, rubbing) = machine.stiffness.topRightCorner(rubbing, 1).transpose();
  machine.directions = MatrixXd::Zero(n, directions);
  machine.friction_N.resize(directions);
  VectorXd& bears = result.bears;
  bears.resize(directions);
  for (Index i = 0; i < directions; ++i) {
    do {
      for (Index k = 0; k < rubbing; ++k)
        machine.directions(k, i) = whole(random, -2, 2) + apart * whole(random, -2, 2);
    } while (machine.directions.col(i).isZero(0));
    machine.friction_N[i] = whole(random, 2, 4);
    const bool limited = whole(random, 0, 2) > 0;
    bears[i] = limited ? (whole(random, 0, 1) == 0 ? 1 : -1) * machine.friction_N[i] : whole(random, -1, 1);
    if (limited) result.at_limit.push_back(i);
  }
  result.state = at_rest(machine);
  result.state.v[rubbing] = whole(random, 0, 1) == 0 ? 1 : -1;
  machine.force_N = machine.damping * result.state.v - machine.directions * bears;
  return result;
}

inline bool parallel(const LinearMachine<>& machine) {
  for (Index i = 0; i < machine.frictions(); ++i) {
    for (Index j = 0; j < i; ++j) {
      const double cosine = machine.directions.col(i).normalized().dot(machine.directions.col(j).normalized());
      if (std::abs(cosine) > 1 - 1e-12) return true;
    }
  }
  return false;
}

}  // namespace
