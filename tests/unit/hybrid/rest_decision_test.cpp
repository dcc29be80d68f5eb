// What is said to be at rest is at rest: friction holds the springs, in every direction and at every ratio of
// frictions.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <string>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"
#include "breakaway/input/input_error.hpp"

namespace rest_decision_test {
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
    for (const auto& outcome : {EventDriven<>(machine).run(start, 5), Adaptive(machine).run(start, 5),
                                TimeStepping<>(machine, {.step_s = 0.01}).run(start, 5)}) {
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

// Where an undamped motion from rest is after a while: it swings about the place where the springs bear the force.
Eigen::VectorXd swung(const Eigen::MatrixXd& stiffness, const Eigen::VectorXd& force_N, const Eigen::VectorXd& start,
                      double time_s) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(stiffness);
  const Eigen::VectorXd rest = stiffness.ldlt().solve(force_N);
  const Eigen::VectorXd cosines = (modes.eigenvalues().cwiseSqrt() * time_s).array().cos();
  return rest + modes.eigenvectors() * cosines.asDiagonal() * modes.eigenvectors().transpose() * (start - rest);
}

// Masses of 1 kg in a row between two walls, with friction on the first, whose springs pull with just as much. Only the
// last one starts to move, so that the pull changes with the power 2 (n - 1) of time: all derivatives that are looked
// at are zero.
TEST(RestDecision, ALimitIsCrossedHoweverSlowlyAForceLeavesIt) {
  for (const Eigen::Index count : {2, 3, 4, 5}) {
    LinearMachine<> machine;
    machine.mass = Eigen::MatrixXd::Identity(count, count);
    machine.damping = Eigen::MatrixXd::Zero(count, count);
    machine.stiffness = 2 * Eigen::MatrixXd::Identity(count, count);
    machine.stiffness.diagonal(1).setConstant(-1);
    machine.stiffness.diagonal(-1).setConstant(-1);
    machine.directions = Eigen::VectorXd::Unit(count, 0);
    machine.friction_N = Eigen::VectorXd::Ones(1);
    const EventDriven<> method{machine};
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(count);
    // Outwards: the first slides from the start, against its friction.
    const Eigen::VectorXd outwards = Eigen::VectorXd::LinSpaced(count, -2.0, -1.0 - static_cast<double>(count));
    const auto slid = method.run({0, outwards, zero}, 1);
    const Eigen::VectorXd truth = swung(machine.stiffness, -Eigen::VectorXd::Unit(count, 0), outwards, 1);
    EXPECT_LE((slid.end.q - truth).cwiseAbs().maxCoeff(), 1e-13) << count;
    // Inwards: the first stays, and the others swing beside it.
    const Eigen::Index others = count - 1;
    const Eigen::VectorXd inwards = Eigen::VectorXd::LinSpaced(count, 5, 5 + 6 * static_cast<double>(others));
    const auto stayed = method.run({0, inwards, zero}, 0.1);
    EXPECT_EQ(stayed.end.q[0], 5) << count;
    const Eigen::VectorXd beside = swung(machine.stiffness.bottomRightCorner(others, others),
                                         5 * Eigen::VectorXd::Unit(others, 0), inwards.tail(others), 0.1);
    EXPECT_LE((stayed.end.q.tail(others) - beside).cwiseAbs().maxCoeff(), 1e-13) << count;
  }
}

// A light mass makes four directions look alike. At a stop in all of them one alone was found to slide, which the other
// three, that hold the machine, cannot let it do: the springs pull with four times what friction holds.
TEST(RestDecision, RestThatFrictionCannotHoldIsRefused) {
  LinearMachine<> machine;
  machine.mass = (Eigen::Matrix3d{} << 0.76249865124163674, -0.38177830227417164, -6.6307161712339662e-07,
                  -0.38177830227417164, 1.0739228967799395, -8.8505046871057613e-06, -6.6307161712339662e-07,
                  -8.8505046871057613e-06, 2.6546012187880836e-10)
                     .finished();
  machine.damping =
      (Eigen::Matrix3d{} << 0.16043676542824617, -0.0075845800546986636, -0.026107046519873608, -0.0075845800546986636,
       0.25104373555799375, -0.25753138960485239, -0.026107046519873608, -0.25753138960485239, 0.30823208745534209)
          .finished();
  machine.stiffness =
      (Eigen::Matrix3d{} << 3.492773859503747, -4.3539388675474564, -1.0171131090150716, -4.3539388675474564,
       10.641035968094853, -2.2799365002086431, -1.0171131090150716, -2.2799365002086431, 6.4242667855225273)
          .finished();
  machine.directions.resize(3, 4);
  machine.directions << -0.52407356556052953, 0.92474040666701351, -0.72974215515176888, 0.98141381695623098,
      0.98557872871919727, 0.7279443168416071, -0.17671663254146353, 0.86830754738850091, 0.57676519977471541,
      0.3722743971897664, 0.55397657619215357, 0.27128358570590927;
  machine.friction_N =
      Eigen::Vector4d{0.10603621529072169, 0.40405860060292798, 0.15579084419795997, 0.36376395432887343};
  const State start{0, Eigen::Vector3d{-0.40689712602722738, -0.18458793832889042, -1.231483525791323},
                    Eigen::Vector3d{-0.39925225133108944, 0.075406262622489173, -0.81581910985143269}};
  EXPECT_THROW(EventDriven<>(machine).run(start, 5.79), breakaway::InputError);
}

}  // namespace
}  // namespace rest_decision_test
