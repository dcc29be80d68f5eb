// Machines whose time scales lie far apart: each is followed at the pace of what it does, or refused with its cost.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/refused.hpp"

namespace stiff_test {
namespace {

using breakaway::hybrid::EventDriven;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::Outcome;
using breakaway::hybrid::Refused;
using breakaway::hybrid::Verdict;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Outcome<Eigen::Dynamic> run(const LinearMachine<>& machine, const VectorXd& q, double end_time_s) {
  return EventDriven<>(machine).run({0, q, VectorXd::Zero(q.size())}, end_time_s);
}

LinearMachine<> light_beside_heavy(double light_kg) {
  LinearMachine<> machine;
  machine.mass = Eigen::Vector2d{1, light_kg}.asDiagonal();
  machine.damping = (Eigen::Matrix2d{} << 0.2, -0.1, -0.1, 0.2).finished();
  machine.stiffness = (Eigen::Matrix2d{} << 2, -1, -1, 2).finished();
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = VectorXd::Constant(1, 0.01);
  return machine;
}

// `count` masses of 1 kg in a row, the first tied to the ground.
LinearMachine<> chain(Eigen::Index count, double stiffness, double damping, double ground) {
  LinearMachine<> machine;
  machine.mass = MatrixXd::Identity(count, count);
  MatrixXd joints = MatrixXd::Zero(count, count);
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    joints.block(i, i, 2, 2) += (Eigen::Matrix2d{} << 1, -1, -1, 1).finished();
  }
  machine.damping = damping * joints;
  machine.stiffness = stiffness * joints;
  machine.stiffness(0, 0) += ground;
  machine.directions = MatrixXd::Identity(count, count);
  machine.friction_N = VectorXd::Constant(count, 0.1);
  return machine;
}

// The light mass follows without inertia as its mass goes to zero: what is left differs by its mass.
TEST(Stiff, ALightMassBesideAHeavyOneIsFollowedAtThePaceOfTheHeavyOne) {
  const auto lightest = run(light_beside_heavy(1e-12), Eigen::Vector2d{8, -3}, 30);
  for (const double light_kg : {1e-3, 1e-6, 1e-9}) {
    const auto outcome = run(light_beside_heavy(light_kg), Eigen::Vector2d{8, -3}, 30);
    EXPECT_LE(outcome.steps, 20U) << light_kg;
    EXPECT_NEAR(outcome.end.q[0], lightest.end.q[0], 10 * light_kg) << light_kg;
  }
}

// Springs of 1e12 N/m make one mass of eight: 8 q'' + k q = -8 f. It starts to move a few microseconds late, because
// the joints break away one after the other.
TEST(Stiff, AStiffChainMovesAsOneMass) {
  const auto outcome = run(chain(8, 1e12, 1e5, 1), VectorXd::Constant(8, 1), 1);
  const double omega = 1 / std::sqrt(8.0), rest = 0.8;
  for (const double q : outcome.end.q) EXPECT_NEAR(q, rest + (1 - rest) * std::cos(omega), 1e-5);
  EXPECT_LE(outcome.steps, 100U);
}

TEST(Stiff, AVibrationThatNeverEndsIsRefusedWithItsCost) {
  VectorXd q = VectorXd::Zero(8);
  q[3] = 1e-3;
  try {
    run(chain(8, 1e12, 0, 1), q, 1);
    FAIL() << "it was followed";
  } catch (const Refused& refusal) {
    EXPECT_NE(std::string(refusal.what()).find("following this machine for 1 s would take about"), std::string::npos);
  }
}

// Two eigenvalues of -1e6 that have one eigenvector: the dense block is theirs alone, and has died out after 1 ms.
TEST(Stiff, ADefectiveStiffPairDiesOutWithoutSlowingTheRest) {
  LinearMachine<> machine;
  machine.mass = MatrixXd::Identity(3, 3);
  machine.damping = Eigen::Vector3d{1e6, 1e6, 0}.asDiagonal();
  machine.damping(1, 0) = -5e5;
  machine.stiffness = Eigen::Vector3d{1e6, 1e6, 1}.asDiagonal();
  machine.directions = Eigen::Vector3d{0, 0, 1};
  machine.friction_N = VectorXd::Constant(1, 1);
  const auto outcome = run(machine, Eigen::Vector3d{1, -1, 4.5}, 100);
  EXPECT_LE(outcome.steps, 10U);
  EXPECT_NEAR(outcome.end.q[2], 0.5, 1e-13);
}

// Dampers of 5e11 Ns/m leave a mass one way to go, along which it is an oscillator with friction: each swing ends at
// rest, where friction has taken 2 f / k of it. At a stop of the other direction of friction, a speed that is rounding
// alone would be felt by the dampers.
TEST(Stiff, ASpeedLeftOverByRoundingIsNotFeltByStrongDampers) {
  const double f = 0.365;
  const Eigen::Vector2d damped{0.6, 0.8}, way{-0.8, 0.6};
  LinearMachine<> machine;
  machine.mass = MatrixXd::Identity(2, 2);
  machine.damping = 2e10 * (Eigen::Matrix2d{} << 9, 12, 12, 16).finished();
  machine.stiffness = (Eigen::Matrix2d{} << 1.2, 0.4, 0.4, 0.9).finished();
  machine.directions = Eigen::Vector2d{0.93688, 0.23084};
  machine.friction_N = VectorXd::Constant(1, f);
  const Eigen::Vector2d start{-2.7, 6.1};
  const double k = way.dot(machine.stiffness * way), limit = f * std::abs(way.dot(machine.directions.col(0)));
  double force = -way.dot(machine.stiffness * start), along = 0;
  while (std::abs(force) > limit) {
    const double swing = 2 * (force - std::copysign(limit, force)) / k;
    along += swing;
    force -= k * swing;
  }
  const auto outcome = run(machine, start, 60);
  EXPECT_NEAR((outcome.end.q - start).dot(way), along, 1e-9);
  EXPECT_NEAR((outcome.end.q - start).dot(damped), 0, 1e-9);
}

}  // namespace
}  // namespace stiff_test
