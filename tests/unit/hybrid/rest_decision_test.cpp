// What is said to be at rest is at rest: friction holds the springs, in every direction and at every ratio of
// frictions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"

namespace {

using breakaway::hybrid::Adaptive;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Outcome;
using breakaway::hybrid::TimeStepping;
using breakaway::hybrid::Verdict;
using State = MachineState<Eigen::Dynamic>;

// A slide of 1 kg with a brake along x and a bearing along x + y, on springs of 100 N/m.
LinearMachine<> braked_slide(double brake_N, double bearing_N) {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = Eigen::Matrix2d::Zero();
  machine.stiffness = 100 * Eigen::Matrix2d::Identity();
  machine.directions = (Eigen::Matrix2d{} << 1, 1, 0, 1).finished();
  machine.friction_N = Eigen::Vector2d{brake_N, bearing_N};
  return machine;
}

// The brake holds x, and y swings against the bearing alone: it loses 2 f / k of amplitude in each half period.
TEST(RestDecision, ABrakeDoesNotHoldWhatOnlyAWeakBearingTouches) {
  for (const double bearing_N : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const LinearMachine<> machine = braked_slide(200, bearing_N);
    const State start{0, Eigen::Vector2d{1, 2}, Eigen::Vector2d{0, 0}};
    const double end_s = 16 * std::numbers::pi / 10;
    const double truth_m = 2 - 16 * 2 * bearing_N / 100;
    const auto event_driven = EventDriven<>(machine).run(start, end_s);
    EXPECT_EQ(event_driven.end.q[0], 1) << bearing_N;
    EXPECT_NEAR(event_driven.end.q[1], truth_m, 2e-13) << bearing_N;
    const auto adaptive = Adaptive(machine).run(start, end_s);
    EXPECT_NEAR(adaptive.end.q[0], 1, 1e-13) << bearing_N;
    EXPECT_NEAR(adaptive.end.q[1], truth_m, 1e-10) << bearing_N;
  }
}

// A strong spring across: the force on x that the moving y makes is within the brake's limit all the time.
TEST(RestDecision, MethodsAgreeWhereFrictionsAreFarApart) {
  for (const double ratio : {2e4, 1e8, 1e12}) {
    LinearMachine<> machine = braked_slide(200, 200 / ratio);
    machine.stiffness = (Eigen::Matrix2d{} << 100, -40, -40, 80).finished();
    machine.damping = 0.1 * Eigen::Matrix2d::Identity();
    for (const double q1 : {1.0, 5.0, -3.0}) {
      const State start{0, Eigen::Vector2d{q1, 2}, Eigen::Vector2d{0.5, 0}};
      const auto event_driven = EventDriven<>(machine).run(start, 5);
      const auto adaptive = Adaptive(machine).run(start, 5);
      EXPECT_EQ(event_driven.verdict, Verdict::undecided);
      EXPECT_EQ(event_driven.events, adaptive.events);
      EXPECT_LT((event_driven.end.q - adaptive.end.q).norm(), 1e-10);
      EXPECT_GT(std::abs(event_driven.end.v[1]), 1e-3);
    }
  }
}

// Brake and bearing exchanged, mirrored and scaled by a power of two: the same bits.
TEST(RestDecision, ScalingAndMirroringKeepTheDecision) {
  const State start{0, Eigen::Vector2d{5, 2}, Eigen::Vector2d{0.5, 0}};
  const auto reference = EventDriven<>(braked_slide(200, 1e-3)).run(start, 5);
  for (const double scale : {0x1p-40, 0x1p40, -1.0}) {
    const double size = std::abs(scale);
    const auto other =
        EventDriven<>(braked_slide(200 * size, 1e-3 * size)).run({0, scale * start.q, scale * start.v}, 5);
    EXPECT_EQ(other.events, reference.events);
    EXPECT_EQ(other.end.q[0], scale * reference.end.q[0]);
    EXPECT_EQ(other.end.q[1], scale * reference.end.q[1]);
  }
}

// x stays where the brake holds it; y has no friction and stands still in its place of rest, exactly.
TEST(RestDecision, EveryMethodSeesRestOfACoordinateWithoutFriction) {
  LinearMachine<> machine = braked_slide(200, 0);
  const State start{0, Eigen::Vector2d{0.5, 0}, Eigen::Vector2d{0, 0}};
  EXPECT_EQ(EventDriven<>(machine).run(start, 5).verdict, Verdict::at_rest);
  EXPECT_EQ(Adaptive(machine).run(start, 5).verdict, Verdict::at_rest);
  EXPECT_EQ(TimeStepping<>(machine).run(start, 5).verdict, Verdict::at_rest);
  const State swings{0, Eigen::Vector2d{0.5, 1e-9}, Eigen::Vector2d{0, 0}};
  EXPECT_NE(EventDriven<>(machine).run(swings, 5).verdict, Verdict::at_rest);
  EXPECT_NE(Adaptive(machine).run(swings, 5).verdict, Verdict::at_rest);
  EXPECT_NE(TimeStepping<>(machine).run(swings, 5).verdict, Verdict::at_rest);
}

// An overdamped mass creeps towards the border of what friction holds and never turns. Begun 1e14 to 1e18 times as far
// away as friction holds, its place is rounded to more than that: what is left of a force then moves it on, to rest.
// Friction holds the force on the first coordinate, and no force acts on the second, which mass couples to it.
TEST(RestDecision, AForceThatFrictionHoldsMovesNoCoupledCoordinate) {
  for (const double coupling_kg : {0.3, 0.1, -0.45, 1e-9}) {
    LinearMachine<> machine;
    machine.mass = (Eigen::Matrix2d{} << 0.5, coupling_kg, coupling_kg, 0.9).finished();
    machine.damping = 0.1 * Eigen::Matrix2d::Identity();
    machine.stiffness = Eigen::Matrix2d::Identity();
    machine.directions = Eigen::Vector2d{1, 0};
    machine.friction_N = Eigen::VectorXd::Constant(1, 1);
    machine.force_N = Eigen::Vector2d{-0.7, 0};
    const State start{0, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
    for (const auto& outcome : {EventDriven<>(machine).run(start, 5), Adaptive(machine).run(start, 5)}) {
      EXPECT_EQ(outcome.verdict, Verdict::at_rest) << coupling_kg;
      EXPECT_EQ(outcome.settling_time_s, 0) << coupling_kg;
    }
  }
}

TEST(RestDecision, ACreepFromFarAwayEndsAtRestWhereFrictionHolds) {
  LinearMachine<> machine;
  machine.mass = Eigen::MatrixXd::Constant(1, 1, 1);
  machine.damping = Eigen::MatrixXd::Constant(1, 1, 3);
  machine.stiffness = machine.directions = Eigen::MatrixXd::Constant(1, 1, 1);
  machine.friction_N = Eigen::VectorXd::Constant(1, 1);
  for (const double end_s : {1e5, 1e9}) {
    for (double start_m = 1e14; std::abs(start_m) < 1e18; start_m *= -7.3) {
      const State start{0, Eigen::VectorXd::Constant(1, start_m), Eigen::VectorXd::Zero(1)};
      const auto outcome = EventDriven<>(machine).run(start, end_s);
      EXPECT_EQ(outcome.verdict, Verdict::at_rest) << start_m;
      EXPECT_EQ(outcome.end.v[0], 0) << start_m;
      EXPECT_LE(std::abs(outcome.end.q[0]), 1 + 1e-12) << start_m;
    }
  }
}

}  // namespace
