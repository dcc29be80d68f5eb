#include "breakaway/stability/sequential_kicks.hpp"

#include <gtest/gtest.h>

#include "breakaway/input/input_error.hpp"

namespace breakaway::stability::sequential_kicks_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd square(double a, double b, double c, double d) { return (MatrixXd(2, 2) << a, b, c, d).finished(); }

// Two axes of 2 kg that throw 0.5 kg at each other, friction 2.5 to 4.5 N, nothing else.
CoupledAxes two_axes() {
  CoupledAxes a;
  a.mass = square(2, 0.5, 0.5, 2);
  a.mass_error = a.damping = a.stiffness = MatrixXd::Zero(2, 2);
  a.load_N = a.brake_N = a.force_step_N = VectorXd::Zero(2);
  a.friction_lower_N = VectorXd::Constant(2, 2.5);
  a.friction_upper_N = VectorXd::Constant(2, 4.5);
  a.max_force_N = VectorXd::Constant(2, 50);
  a.period_s = 1e-3;
  return a;
}

VectorXd box() { return VectorXd::Constant(2, 0.01); }

double needed(const CoupledAxes& a, double force_N, KickPhase phase) {
  for (const PairCondition& c : pair_conditions(a, box(), force_N, 0, 1)) {
    if (c.phase == phase) return c.needed_N;
  }
  ADD_FAILURE() << "no such phase";
  return 0;
}

TEST(SequentialKicks, WithExactMassesHalfOfTheSpreadOfFrictionIsFeltInThePulse) {
  EXPECT_DOUBLE_EQ(needed(two_axes(), 20, KickPhase::pulse), 0.25 * (4.5 - 2.5) / 2);
  EXPECT_DOUBLE_EQ(needed(two_axes(), 40, KickPhase::pulse), 0.25 * (4.5 - 2.5) / 2);
}

TEST(SequentialKicks, HalfOfTheGreatestFrictionAndTheBrakeIsFeltInTheCoast) {
  CoupledAxes a = two_axes();
  a.brake_N = VectorXd::Constant(2, 2);
  EXPECT_DOUBLE_EQ(needed(a, 20, KickPhase::coast), 0.25 * (4.5 + 2) / 2);
}

TEST(SequentialKicks, WhatTheMassesLeaveOpenIsFeltOfTheWholeForce) {
  CoupledAxes a = two_axes();
  a.mass_error(0, 1) = a.mass_error(1, 0) = 0.1;
  EXPECT_NEAR(needed(a, 20, KickPhase::pulse), 0.25 * 1 + 0.05 * (20 - 2.5), 1e-12);
  EXPECT_NEAR(needed(a, 20, KickPhase::coast), 0.25 * 2.25 + 0.05 * 4.5, 1e-12);
}

TEST(SequentialKicks, TheShareOfAnInexactMassIsTheMiddleOfItsRange) {
  CoupledAxes a = two_axes();
  a.mass_error = square(0.5, 0.1, 0.1, 0);
  const Coupling c = coupling(a, 0, 1);
  EXPECT_DOUBLE_EQ(c.hold_off + c.deviation, 0.6 / 1.5);
  EXPECT_DOUBLE_EQ(c.hold_off - c.deviation, 0.4 / 2.5);
}

TEST(SequentialKicks, AnAxisWithoutADriveFeelsAllOfTheAcceleration) {
  CoupledAxes a = two_axes();
  a.max_force_N[1] = 0;
  EXPECT_DOUBLE_EQ(needed(a, 10, KickPhase::pulse), 0.25 * (10 - 2.5));
  EXPECT_DOUBLE_EQ(needed(a, 10, KickPhase::coast), 0.25 * 4.5);
}

TEST(SequentialKicks, ACurrentLoopThatLagsAddsTheStartOfThePulse) {
  CoupledAxes a = two_axes();
  EXPECT_EQ(pair_conditions(a, box(), 20, 0, 1).size(), 3U);
  a.lag_s = 1e-4;
  EXPECT_DOUBLE_EQ(needed(a, 20, KickPhase::start), 0.25 * (4.5 - 3.5 * 2.5 / 20));
}

TEST(SequentialKicks, SpringsLoadsAndStepsOfForceTakeFromTheFrictionOfBoth) {
  CoupledAxes a = two_axes();
  a.stiffness = square(10, -10, -10, 10);
  a.load_N = VectorXd::Constant(2, 0.1);
  a.force_step_N = VectorXd::Constant(2, 0.02);
  const double beside = 0.1 + 10 * 0.02 + 0.01;
  const KickedAxis k = kicked_axis(a, box(), 0);
  EXPECT_DOUBLE_EQ(k.lower_N, 2.5 - beside);
  EXPECT_DOUBLE_EQ(k.upper_N, 4.5 + beside);
  EXPECT_DOUBLE_EQ(free_friction_N(a, box(), 1), 2.5 - beside);
  EXPECT_NEAR(needed(a, 20, KickPhase::pulse), 0.25 * (1 + beside) + beside, 1e-12);
}

TEST(SequentialKicks, TheForceThatGoesADistanceGoesIt) {
  CoupledAxes a = two_axes();
  a.brake_N = VectorXd::Constant(2, 1);
  const KickedAxis k = kicked_axis(a, box(), 0);
  for (const double y_m : {1e-6, 1e-4, 5e-3}) EXPECT_NEAR(k.most_travel_m(k.force_N(y_m, 3e-3), 3e-3), y_m, 1e-12);
  // By hand: (20 - 2.5) (20 + 1) 1e-6 / (2 2 (2.5 + 1)).
  EXPECT_DOUBLE_EQ(k.most_travel_m(20, 1e-3), 17.5 * 21e-6 / 14);
}

TEST(SequentialKicks, ALaggingLoopIsSureOfLess) {
  CoupledAxes a = two_axes();
  const double without_m = kicked_axis(a, box(), 0).least_travel_m(20, 1e-3);
  a.lag_s = 1e-4;
  const KickedAxis k = kicked_axis(a, box(), 0);
  EXPECT_LT(k.least_travel_m(20, 1e-3), without_m);
  EXPECT_GT(k.least_travel_m(k.sure_N, 1e-3), 0);
  EXPECT_GT(k.sure_N, sure_share * k.upper_N);
}

TEST(SequentialKicks, TheLargestKickIsWhereTheTightestPairGivesWay) {
  CoupledAxes a = two_axes();
  a.mass_error(0, 1) = a.mass_error(1, 0) = 0.1;
  const double largest_N = largest_kick_N(a, box(), 4.6, 50, 0);
  // 0.25 + 0.05 (F - 2.5) = 2.5.
  EXPECT_NEAR(largest_N, 47.5, 1e-9);
  EXPECT_FALSE(tightest(a, box(), 47.6, 0).holds());
  EXPECT_EQ(tightest(a, box(), 47.6, 0).held, 1);
  EXPECT_EQ(largest_kick_N(a, box(), 4.6, 30, 0), 30);
  EXPECT_EQ(largest_kick_N(a, box(), 48, 50, 0), 0);
}

TEST(SequentialKicks, TheHeldAxisNeedsADriveThatGivesTheHoldOffForce) {
  CoupledAxes a = two_axes();
  a.max_force_N[1] = 3;
  // 0.25 (F - 3.5) = 3.
  EXPECT_NEAR(largest_kick_N(a, box(), 4.6, 50, 0), 15.5, 1e-9);
  EXPECT_EQ(tightest(a, box(), 16, 0).phase, KickPhase::hold_off);
}

TEST(SequentialKicks, AxesThatPushEachOtherHardCannotBeKickedAtOnce) {
  CoupledAxes a = two_axes();
  const VectorXd force_N = VectorXd::Constant(2, 20);
  EXPECT_TRUE(simultaneous_condition(a, box(), force_N, 0, 1).holds());
  a.mass = square(2, 1.6, 1.6, 2);
  EXPECT_FALSE(simultaneous_condition(a, box(), force_N, 0, 1).holds());
  EXPECT_EQ(simultaneous_condition(a, box(), force_N, 0, 1).held, 0);
}

TEST(SequentialKicks, AMachineThatIsNoneIsRefusedWithAWord) {
  CoupledAxes a = two_axes();
  a.mass(0, 1) = a.mass(1, 0) = 3;
  EXPECT_THROW(require_valid(a), InputError);
  a = two_axes();
  a.friction_lower_N[1] = 0;
  EXPECT_THROW(require_valid(a), InputError);
  a = two_axes();
  a.load_N = VectorXd::Zero(3);
  EXPECT_THROW(require_valid(a), InputError);
}

}  // namespace
}  // namespace breakaway::stability::sequential_kicks_test
