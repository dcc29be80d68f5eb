// What sticks and what slips next, against Gauss' principle of least constraint: several directions at once, dependent
// ones, either side, and forces of which rounding has left little.
#include "breakaway/hybrid/friction_groups.hpp"
#include "breakaway/hybrid/refused.hpp"
#include "gauss_truth.hpp"

namespace hybrid_modes_test {
namespace {

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
}  // namespace hybrid_modes_test
