// What sticks and what slips next, against Gauss' principle of least constraint on numbers of 113 bits, which shares
// nothing with it: several directions at once, dependent ones, either side, at the very limit and beyond it.
#include "breakaway/hybrid/hybrid_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "../../campaign/friction_decision.hpp"
#include "breakaway/hybrid/friction_groups.hpp"
#include "breakaway/hybrid/refused.hpp"

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

double between(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 8) / 0x1p24;
}
int whole(std::mt19937& random, int low, int high) {
  return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
}
MatrixXd drawn(std::mt19937& random, Index rows, Index columns, double size) {
  MatrixXd result(rows, columns);
  for (double& x : result.reshaped()) x = between(random, -size, size);
  return result;
}
MatrixXd drawn_mass(std::mt19937& random, Index size) {
  const MatrixXd factor = drawn(random, size, size, 1);
  return factor * factor.transpose() + 0.3 * MatrixXd::Identity(size, size);
}

campaign::Matrix<Quad> quad(const MatrixXd& from) {
  campaign::Matrix<Quad> result(static_cast<std::size_t>(from.rows()), static_cast<std::size_t>(from.cols()));
  for (Index i = 0; i < from.rows(); ++i) {
    for (Index j = 0; j < from.cols(); ++j)
      result(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = Quad(from(i, j));
  }
  return result;
}

// The signs that Gauss' principle gives to the `stopped` directions.
std::vector<int> truth(const LinearMachine<>& machine, const State& state, DirectionSet stopped) {
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

std::vector<int> signs_of(const State& state) { return {state.signs.begin(), state.signs.end()}; }

// What sticks has no sign, and everything else has one.
void expect_signs(const State& state, const std::vector<int>& signs, const std::string& what) {
  EXPECT_EQ(signs_of(state), signs) << what;
  for (Index i = 0; i < state.signs.size(); ++i) EXPECT_EQ(contains(state.sticking, i), state.signs[i] == 0) << what;
}

DirectionSet all_of(const LinearMachine<>& machine) { return only(machine.frictions()) - 1; }

LinearMachine<> drawn_machine(std::mt19937& random, Index coordinates, Index directions) {
  LinearMachine<> machine;
  machine.mass = drawn_mass(random, coordinates);
  machine.damping = drawn(random, coordinates, coordinates, 1);
  machine.stiffness = drawn(random, coordinates, coordinates, 2);
  machine.directions = drawn(random, coordinates, directions, 1);
  machine.friction_N = drawn(random, directions, 1, 0.9).array() + 1;
  machine.force_N = drawn(random, coordinates, 1, 3);
  return machine;
}

State at_rest(const LinearMachine<>& machine) {
  State state;
  state.q = state.v = VectorXd::Zero(machine.coordinates());
  state.signs = VectorXd::Zero(machine.frictions());
  return state;
}

// A velocity with which these directions stand, and the signs of the others. Dependent directions stand with them.
DirectionSet move(std::mt19937& random, const LinearMachine<>& machine, DirectionSet stand, State& state) {
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

TEST(HybridModes, WhatStopsTogetherSticksOrSlidesAsGaussPrincipleSays) {
  std::mt19937 random(1);
  Met met;
  for (int trial = 0; trial < 600; ++trial) {
    const Index coordinates = whole(random, 1, 4), directions = whole(random, 1, 5);
    const LinearMachine<> machine = drawn_machine(random, coordinates, directions);
    const Modes modes(machine);
    State state = at_rest(machine);
    state.q = drawn(random, coordinates, 1, 1);
    const DirectionSet asked = static_cast<DirectionSet>(random()) & all_of(machine);
    const DirectionSet stopped = move(random, machine, asked, state);
    const std::vector<int> signs = truth(machine, state, stopped);
    modes.choose(state, asked);
    expect_signs(state, signs, "machine " + std::to_string(trial));
    if (stopped != 0) met.add(state, stopped);
  }
  EXPECT_GT(met.stick, 50);
  EXPECT_GT(met.slide, 50);
  EXPECT_GT(met.mixed, 50);
}

// Forces of friction of which some are at their limits, and a coordinate without friction that changes the load on all
// of them through springs: its velocity says which of them give way.
struct AtLimits {
  LinearMachine<> machine;
  State state;
  VectorXd bears;
  std::vector<Index> at_limit;
};
AtLimits at_limits(std::mt19937& random, Index rubbing, Index directions, double apart = 0) {
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

bool parallel(const LinearMachine<>& machine) {
  for (Index i = 0; i < machine.frictions(); ++i) {
    for (Index j = 0; j < i; ++j) {
      const double cosine = machine.directions.col(i).normalized().dot(machine.directions.col(j).normalized());
      if (std::abs(cosine) > 1 - 1e-12) return true;
    }
  }
  return false;
}

TEST(HybridModes, OfDirectionsAtTheirLimitsThoseSlideThatTheRateOfTheForcesDrives) {
  std::mt19937 random(2);
  Met met;
  for (int trial = 0; trial < 600; ++trial) {
    const Index rubbing = whole(random, 1, 4);
    AtLimits at = at_limits(random, rubbing, rubbing + (rubbing > 1 ? whole(random, -1, 1) : 0));
    if (parallel(at.machine)) continue;
    const DirectionSet all = all_of(at.machine);
    const std::vector<int> signs = truth(at.machine, at.state, all);
    Modes(at.machine).choose(at.state, all);
    expect_signs(at.state, signs, "machine " + std::to_string(trial));
    met.add(at.state, all);
  }
  EXPECT_GT(met.stick, 50);
  EXPECT_GT(met.slide, 50);
  EXPECT_GT(met.mixed, 50);
}

// Of directions that differ by a thousandth what gives way is as sure. By a millionth some are taken to stay at their
// limits, or to leave them, by a rate that is rounding: the number is that of today, and may only become less.
TEST(HybridModes, OfNearlyParallelDirectionsAtTheirLimitsThoseSlideThatTheRateDrives) {
  int wrong = 0, decided = 0;
  for (unsigned trial = 0; trial < 1500; ++trial) {
    std::mt19937 random(trial);
    const Index rubbing = whole(random, 2, 4);
    const int bits = whole(random, 4, 20);
    AtLimits at = at_limits(random, rubbing, rubbing + whole(random, 0, 2), std::ldexp(1.0, -bits));
    if (parallel(at.machine)) continue;
    const DirectionSet all = all_of(at.machine);
    const std::vector<int> signs = truth(at.machine, at.state, all);
    Modes(at.machine).choose(at.state, all);
    ++decided;
    if (signs_of(at.state) != signs) ++wrong;
    expect_signs(at.state, bits <= 10 ? signs : signs_of(at.state), "machine " + std::to_string(trial));
  }
  EXPECT_EQ(decided, 1453);
  EXPECT_LE(wrong, 9);
}

TEST(HybridModes, WhatIsAtItsLimitsStaysWhereItIsToBeKept) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const Index rubbing = whole(random, 1, 4);
    AtLimits at = at_limits(random, rubbing, rubbing);
    if (parallel(at.machine)) continue;
    Modes(at.machine).choose(at.state, all_of(at.machine), true);
    expect_signs(at.state, std::vector<int>(static_cast<std::size_t>(rubbing), 0), std::to_string(trial));
  }
}

// A mass of 1 with a friction of 1, pushed by `push_N`, and a second coordinate without friction, which is `fast` and
// takes from the push what it moves.
LinearMachine<> pushed(double push_N) {
  LinearMachine<> machine;
  machine.mass = MatrixXd::Identity(2, 2);
  machine.damping = MatrixXd::Zero(2, 2);
  machine.stiffness = (Eigen::Matrix2d{} << 1, -1, -1, 1).finished();
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = VectorXd::Ones(1);
  machine.force_N = Eigen::Vector2d{push_N, 0};
  return machine;
}

double sign_of_pushed(double push_N, double fast) {
  const LinearMachine<> machine = pushed(push_N);
  State state = at_rest(machine);
  state.v[1] = fast;
  Modes(machine).choose(state, 1);
  EXPECT_EQ(state.sticking, state.signs[0] == 0 ? 1U : 0U);
  return state.signs[0];
}

TEST(HybridModes, ALimitIsWidenedByATieAndReachedATenthOfOneBeforeIt) {
  constexpr double tie = 1e-12;
  for (const double side : {1.0, -1.0}) {
    EXPECT_EQ(sign_of_pushed(side * (1 + 1.1 * tie), -side), side);
    EXPECT_EQ(sign_of_pushed(side * (1 + 0.9 * tie), -side), 0);
    EXPECT_EQ(sign_of_pushed(side, side), side);
    EXPECT_EQ(sign_of_pushed(side, -side), 0);
    EXPECT_EQ(sign_of_pushed(side, 0), 0);
    EXPECT_EQ(sign_of_pushed(side * (1 - 0.08 * tie), side), side);
    EXPECT_EQ(sign_of_pushed(side * (1 - 0.1 * tie), side), side);
    EXPECT_EQ(sign_of_pushed(side * (1 - 0.12 * tie), side), 0);
  }
}

// Two speeds whose forces change alike and opposite, but for the rounding of their products.
TEST(HybridModes, AForceThatChangesByRoundingAloneMovesNothing) {
  for (const double side : {1.0, -1.0}) {
    for (const double way : {1.0, -1.0}) {
      LinearMachine<> machine;
      machine.mass = MatrixXd::Identity(3, 3);
      machine.damping = MatrixXd::Zero(3, 3);
      machine.stiffness = (Eigen::Matrix3d{} << 1, -0.1, -0.3, -0.1, 1, 0, -0.3, 0, 1).finished();
      machine.directions = Eigen::Vector3d{1, 0, 0};
      machine.friction_N = VectorXd::Ones(1);
      machine.force_N = Eigen::Vector3d{side, 0, 0};
      State state = at_rest(machine);
      state.v = way * Eigen::Vector3d{0, 3, -1};
      ASSERT_NE(machine.stiffness.row(0).dot(state.v), 0);
      Modes(machine).choose(state, 1);
      EXPECT_EQ(state.signs[0], 0);
      state.v[1] = way * 3 * (1 + 3e-12);
      Modes(machine).choose(state, 1);
      EXPECT_EQ(state.signs[0], side == way ? side : 0);
    }
  }
}

// Two free coordinates, on which only springs of their own act, change the load by 0.3 each way: what differs by less
// than 1e-12 of the terms that it is the sum of is no change.
TEST(HybridModes, AForceThatChangesByLessThanItsTermsTellMovesNothing) {
  for (const double side : {1.0, -1.0}) {
    for (const double way : {1.0, -1.0}) {
      LinearMachine<> machine;
      machine.mass = MatrixXd::Identity(3, 3);
      machine.damping = MatrixXd::Zero(3, 3);
      machine.stiffness = (Eigen::Matrix3d{} << 1, -0.1, -0.3, 0, 4, 0, 0, 0, 9).finished();
      machine.directions = Eigen::Vector3d{1, 0, 0};
      machine.friction_N = VectorXd::Ones(1);
      machine.force_N = Eigen::Vector3d{side, 0, 0};
      for (const double more : {2e-12, 3.5e-12}) {
        State state = at_rest(machine);
        state.v = way * Eigen::Vector3d{0, 3 * (1 + more), -1};
        Modes(machine).choose(state, 1);
        EXPECT_EQ(state.signs[0], more > 3e-12 && side == way ? side : 0);
      }
    }
  }
}

TEST(HybridModes, ADirectionWithoutFrictionNeverSticks) {
  LinearMachine<> machine = pushed(0);
  machine.directions = MatrixXd::Zero(2, 2);
  machine.directions(0, 1) = 1;
  machine.friction_N = Eigen::Vector2d{0, 1};
  const Modes modes(machine);
  State state = at_rest(machine);
  state.signs[1] = 1;
  modes.choose(state, 0b01);
  EXPECT_EQ(state.sticking, 0U);
  EXPECT_EQ(state.signs, (Eigen::Vector2d{0, 1}));
}

// What is crossed gives way, whether or not the change of the force says so.
TEST(HybridModes, TheFaceThatIsCrossedGivesWay) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 300; ++trial) {
    const Index count = whole(random, 1, 3);
    LinearMachine<> machine = drawn_machine(random, count, count);
    machine.damping.setZero();
    const VectorXd bears = drawn(random, count, 1, 1).cwiseProduct(machine.friction_N);
    VectorXd at_limit = bears;
    const Index crossed = whole(random, 0, static_cast<int>(count) - 1);
    const double side = whole(random, 0, 1) == 0 ? 1 : -1;
    at_limit[crossed] = -side * machine.friction_N[crossed];
    machine.force_N = -machine.directions * at_limit;
    const Modes modes(machine);
    State state = at_rest(machine);
    state.sticking = all_of(machine);
    const auto& facets = modes.set(state.sticking).facets;
    for (std::size_t k = 0; k < facets.size(); ++k) {
      if (facets[k].share[crossed] != 0) modes.release(state, static_cast<int>(k));
    }
    std::vector<int> signs(static_cast<std::size_t>(count), 0);
    signs[static_cast<std::size_t>(crossed)] = static_cast<int>(side);
    expect_signs(state, signs, "machine " + std::to_string(trial));
  }
}

TEST(HybridModes, TheFaceThatIsCrossedGivesWayWithThoseThatTheRateDrives) {
  std::mt19937 random(5);
  Met met;
  for (int trial = 0; trial < 200; ++trial) {
    const Index count = whole(random, 2, 4);
    AtLimits at = at_limits(random, count, count);
    if (parallel(at.machine) || at.machine.directions.fullPivLu().rank() < count) continue;
    const DirectionSet all = all_of(at.machine);
    const std::vector<int> driven = truth(at.machine, at.state, all);
    const Modes modes(at.machine);
    const auto& facets = modes.set(all).facets;
    for (const Index crossed : at.at_limit) {
      std::vector<int> signs = driven;
      const auto place = static_cast<std::size_t>(crossed);
      // Without damping of its own what slides because rounding says so changes nothing for the others.
      if (signs[place] == 0) signs[place] = at.bears[crossed] > 0 ? -1 : 1;
      State state = at.state;
      state.sticking = all;
      for (std::size_t k = 0; k < facets.size(); ++k) {
        if (facets[k].share[crossed] != 0) modes.release(state, static_cast<int>(k));
      }
      expect_signs(state, signs, "machine " + std::to_string(trial) + ", face of " + std::to_string(crossed));
      met.add(state, all);
    }
  }
  EXPECT_GT(met.slide, 10);
  EXPECT_GT(met.mixed, 50);
}

// A spring that pulls with a force of 2^50 against a constant one: what is left of the two is rounded to less than 4.
constexpr double large_N = 0x1p50;

// The first of two independent masses is pushed by 2 more than its friction and by such a spring, the second by 8.
TEST(HybridModes, APushThatRoundingMayHaveMadeSticks) {
  for (const double side : {1.0, -1.0}) {
    for (const Index first : {0, 1}) {
      const Index second = 1 - first;
      LinearMachine<> machine;
      machine.mass = machine.stiffness = machine.directions = MatrixXd::Identity(2, 2);
      machine.damping = MatrixXd::Zero(2, 2);
      machine.friction_N = Eigen::Vector2d::Ones();
      machine.force_N.resize(2);
      machine.force_N[first] = side * (large_N + 3);
      machine.force_N[second] = -side * 8;
      State state = at_rest(machine);
      state.q[first] = side * large_N;
      Modes(machine).choose(state, 0b11);
      EXPECT_EQ(state.sticking, only(first));
      EXPECT_EQ(state.signs[first], 0);
      EXPECT_EQ(state.signs[second], -side);
      // The same push of forces that are as small is none of rounding.
      machine.force_N[first] = side * 3;
      state = at_rest(machine);
      Modes(machine).choose(state, 0b11);
      EXPECT_EQ(state.sticking, 0U);
    }
  }
}

// A strong friction along x holds the large forces. A weak one across it, of which a part is along x, seems to be
// pushed by rounding alone; the force along y, which is none of it, is four times what it can hold.
TEST(HybridModes, APushThatNoRoundingCanHaveMadeSlides) {
  for (const double side : {1.0, -1.0}) {
    for (const Index strong : {0, 1}) {
      const Index weak = 1 - strong;
      LinearMachine<> machine;
      machine.mass = machine.stiffness = MatrixXd::Identity(2, 2);
      machine.damping = MatrixXd::Zero(2, 2);
      machine.directions =
          (Eigen::Matrix2d{} << 1, 1, 0.5 * static_cast<double>(strong), 0.5 * static_cast<double>(weak)).finished();
      machine.friction_N.resize(2);
      machine.friction_N[strong] = 3;
      machine.friction_N[weak] = 1;
      machine.force_N = side * Eigen::Vector2d{large_N, 2};
      State state = at_rest(machine);
      state.q[0] = side * large_N;
      Modes(machine).choose(state, 0b11);
      EXPECT_EQ(state.sticking, only(strong));
      EXPECT_EQ(state.signs[strong], 0);
      EXPECT_EQ(state.signs[weak], side);
    }
  }
}

// A light coordinate on which every direction acts makes them all look alike: in double precision some of their
// accelerations are rounding, and what is left of the decision may be impossible. What sticks beside the truth is what
// rounding alone may have pushed, and that is rare.
TEST(HybridModes, WhatLooksAlikeBesideALightMassIsDecidedRightOrRefused) {
  int slid = 0, ties = 0, refused = 0;
  for (unsigned trial = 0; trial < 3000; ++trial) {
    std::mt19937 random(trial);
    const Index coordinates = whole(random, 2, 3), directions = coordinates + whole(random, 0, 2);
    LinearMachine<> machine = drawn_machine(random, coordinates, directions);
    const double light = std::ldexp(1.0, -whole(random, 14, 27));
    machine.mass.row(coordinates - 1) *= light;
    machine.mass.col(coordinates - 1) *= light;
    machine.damping.setZero();
    machine.stiffness.setZero();
    if (trial % 2 == 0) {
      for (double& friction_N : machine.friction_N) friction_N = std::ldexp(friction_N, -whole(random, 0, 16));
    }
    const VectorXd bears = 1.3 * drawn(random, directions, 1, 1).cwiseProduct(machine.friction_N);
    machine.force_N = -machine.directions * bears;
    State state = at_rest(machine);
    const std::vector<int> signs = truth(machine, state, all_of(machine));
    try {
      Modes(machine).choose(state, all_of(machine));
    } catch (const breakaway::hybrid::Refused&) {
      ++refused;
      continue;
    }
    const std::vector<int> found = signs_of(state);
    if (state.sticking != all_of(machine)) ++slid;
    if (found != signs) ++ties;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE(found[i] == signs[i] || found[i] == 0) << "machine " << trial;
    }
    expect_signs(state, found, "machine " + std::to_string(trial));
  }
  EXPECT_GT(slid, 600);
  EXPECT_LT(ties, 10);
  EXPECT_LE(refused, 394);
}

// A free mass hangs in the balance of two large forces, and is damped against one at its limit. What is left of them,
// and so how the damper's force changes, is rounding.
TEST(HybridModes, AnAccelerationThatIsRoundingMovesNothing) {
  for (const double side : {1.0, -1.0}) {
    for (const double damping : {1.0, -1.0}) {
      LinearMachine<> machine;
      machine.mass = machine.stiffness = MatrixXd::Identity(2, 2);
      machine.damping = (Eigen::Matrix2d{} << 0, damping, 0, 0).finished();
      machine.directions = Eigen::Vector2d{1, 0};
      machine.friction_N = VectorXd::Ones(1);
      for (const double accelerates : {1.0, -1.0}) {
        machine.force_N = Eigen::Vector2d{side, large_N + accelerates};
        State state = at_rest(machine);
        state.q[1] = large_N;
        Modes(machine).choose(state, 1);
        EXPECT_EQ(state.signs[0], 0);
        // The same acceleration of small forces drives it.
        machine.force_N[1] = accelerates;
        state = at_rest(machine);
        Modes(machine).choose(state, 1);
        EXPECT_EQ(state.signs[0], -damping * accelerates == side ? side : 0);
      }
    }
  }
}

// Two directions that are nearly parallel hold the first coordinate; a third one holds the last one and a part of it.
LinearMachine<> nearly_parallel_pair(double angle, Index third, double third_N) {
  LinearMachine<> machine;
  machine.mass = MatrixXd::Identity(3, 3);
  machine.damping = machine.stiffness = MatrixXd::Zero(3, 3);
  machine.directions = MatrixXd::Zero(3, 3);
  machine.directions.row(0).setOnes();
  machine.directions(0, third) = 0.625;
  machine.directions(1, (third + 2) % 3) = angle;
  machine.directions(2, third) = 0.75;
  machine.friction_N = VectorXd::Ones(3);
  machine.friction_N[third] = third_N;
  return machine;
}

// In double precision a push of 1e-8 beyond its friction is less than what is known of the forces that hold the pair.
TEST(HybridModes, AWeakPushBesideNearlyParallelDirectionsIsToldFromRounding) {
  for (const double side : {1.0, -1.0}) {
    for (const Index third : {0, 1, 2}) {
      LinearMachine<> machine = nearly_parallel_pair(0x1p-14, third, 0.25);
      machine.force_N = side * Eigen::Vector3d{0.25, 0, 0.75 * (0.25 + 1e-8)};
      State state = at_rest(machine);
      Modes(machine).choose(state, 0b111);
      EXPECT_EQ(state.sticking, 0b111 & ~only(third));
      EXPECT_EQ(state.signs, (side * Eigen::Vector3d::Unit(third)).eval());
    }
  }
}

// Springs that all but balance: what their rounding would leave open is decided for the state as it is.
TEST(HybridModes, SpringsThatBalanceAreTakenForExactWhereNothingElseDecides) {
  for (const double side : {1.0, -1.0}) {
    LinearMachine<> machine = nearly_parallel_pair(0x1p-20, 2, 0x1p-12);
    machine.force_N = VectorXd::Zero(3);
    machine.stiffness = (Eigen::Matrix3d{} << 0x1p43, -0x1p43, 0, 0, 0, 0, 0, 0, 1).finished();
    State state = at_rest(machine);
    state.q = side * Eigen::Vector3d{1, 1 + 0x1p-52, -0x1p-10};
    Modes(machine).choose(state, 0b111);
    EXPECT_EQ(state.sticking, 0b011U);
    EXPECT_EQ(state.signs[2], side);
  }
}

double power_of_ten(std::mt19937& random, double most) { return std::pow(10.0, -between(random, 0, most)); }

// Masses, frictions and angles up to 1e10 apart, with most directions at their limits to rounding.
LinearMachine<> ill_scaled(std::mt19937& random) {
  const Index n = whole(random, 1, 4), directions = whole(random, 2, 6);
  LinearMachine<> machine = drawn_machine(random, n, directions);
  if (whole(random, 0, 1) == 1) {
    for (Index k = 0; k < n; ++k) {
      const double light = power_of_ten(random, 10);
      machine.mass.row(k) *= light;
      machine.mass.col(k) *= light;
    }
  }
  const double angle = power_of_ten(random, 11);
  for (const Index like_the_first : {1, 3}) {
    if (like_the_first >= directions || whole(random, 0, 1) == 0) continue;
    machine.directions.col(like_the_first) =
        (machine.directions.col(0) + angle * machine.directions.col(like_the_first)).eval();
  }
  if (whole(random, 0, 1) == 1) {
    for (double& friction_N : machine.friction_N) friction_N *= power_of_ten(random, 10);
  }
  machine = breakaway::hybrid::group_frictions(machine).machine;
  VectorXd bears = drawn(random, directions, 1, 1);
  for (double& share : bears) {
    if (whole(random, 0, 2) > 0) share = share > 0 ? 1 : -1;
  }
  machine.force_N = -machine.directions * bears.cwiseProduct(machine.friction_N);
  return machine;
}

// Rounding may decide what such a machine does, but never that something sticks and slides at once.
TEST(HybridModes, NothingSticksAndSlidesAtOnceHoweverHardItIsToTell) {
  int decided = 0;
  for (unsigned trial = 0; trial < 4000; ++trial) {
    std::mt19937 random(trial);
    const LinearMachine<> rubbing = ill_scaled(random);
    const Index n = rubbing.coordinates();
    // A free coordinate changes the load.
    LinearMachine<> machine = rubbing;
    machine.mass = machine.stiffness = machine.damping = MatrixXd::Identity(n + 1, n + 1);
    machine.mass.topLeftCorner(n, n) = rubbing.mass;
    machine.stiffness.col(n).head(n) = drawn(random, n, 1, 1);
    machine.damping.col(n) = drawn(random, n + 1, 1, 1);
    machine.directions = MatrixXd::Zero(n + 1, rubbing.frictions());
    machine.directions.topRows(n) = rubbing.directions;
    State state = at_rest(machine);
    state.v[n] = whole(random, 0, 1) == 0 ? 1 : -1;
    machine.force_N = machine.damping * state.v;
    machine.force_N.head(n) += rubbing.force_N;
    const Modes modes(machine);
    try {
      modes.choose(state, all_of(machine));
    } catch (const breakaway::hybrid::Refused&) {
      continue;
    }
    ++decided;
    for (Index i = 0; i < machine.frictions(); ++i) {
      if (modes.frictionless(i)) continue;
      EXPECT_EQ(contains(state.sticking, i), state.signs[i] == 0) << "machine " << trial;
    }
  }
  EXPECT_GT(decided, 3500);
}

}  // namespace
