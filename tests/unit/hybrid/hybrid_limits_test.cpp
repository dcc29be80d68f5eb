// What gives way of directions at the very limit of static friction: those that the rate of the forces drives.
#include "gauss_truth.hpp"

namespace hybrid_limits_test {
namespace {

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

}  // namespace
}  // namespace hybrid_limits_test
