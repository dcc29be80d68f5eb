// Directions of 0 N hold nothing, whatever they depend on: the machine moves as it does without them.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/hybrid/time_stepping.hpp"

namespace switched_off_test {
namespace {

using breakaway::hybrid::Adaptive;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::TimeStepping;
using State = MachineState<Eigen::Dynamic>;

LinearMachine<> two_masses() {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = (Eigen::Matrix2d{} << 0.125, 0.375, 0.375, 0.125).finished();
  machine.stiffness = (Eigen::Matrix2d{} << 2, -1, -1, 2).finished();
  machine.directions = Eigen::Matrix2d::Identity();
  machine.friction_N = Eigen::Vector2d{1, 1};
  return machine;
}

LinearMachine<> with_direction(LinearMachine<> machine, const Eigen::VectorXd& direction, double friction_N) {
  const Eigen::Index m = machine.frictions();
  machine.directions.conservativeResize(Eigen::NoChange, m + 1);
  machine.directions.col(m) = direction;
  machine.friction_N.conservativeResize(m + 1);
  machine.friction_N[m] = friction_N;
  return machine;
}

template <class Method>
void expect_same(const LinearMachine<>& machine, const LinearMachine<>& switched_off, const State& start,
                 double end_s) {
  const auto without = Method(machine).run(start, end_s), with = Method(switched_off).run(start, end_s);
  EXPECT_EQ(with.verdict, without.verdict);
  EXPECT_EQ(with.steps, without.steps);
  EXPECT_EQ(with.end.q, without.end.q);
  EXPECT_EQ(with.end.v, without.end.v);
}

TEST(SwitchedOff, ARelativeDirectionLeavesTheTwoMassExampleAlone) {
  const LinearMachine<> machine = two_masses();
  const LinearMachine<> switched_off = with_direction(machine, Eigen::Vector2d{1, -1}, 0);
  for (const Eigen::Vector2d& q : {Eigen::Vector2d{4, 2}, Eigen::Vector2d{3, 3}, Eigen::Vector2d{0.1, 0.1}}) {
    const State start{0, q, Eigen::Vector2d{0, 0}};
    expect_same<EventDriven<>>(machine, switched_off, start, 60);
    expect_same<Adaptive>(machine, switched_off, start, 60);
    expect_same<TimeStepping<>>(machine, switched_off, start, 10);
  }
}

TEST(SwitchedOff, RandomDirectionsLeaveRandomMachinesAlone) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); }).eval();
  };
  for (int trial = 0; trial < 100; ++trial) {
    SCOPED_TRACE(trial);
    const Eigen::Index n = 2 + trial % 3, m = 1 + trial % 4;
    const Eigen::MatrixXd root = matrix(n, n);
    const LinearMachine<> machine{Eigen::MatrixXd::Identity(n, n),
                                  0.1 * matrix(n, n),
                                  root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n),
                                  matrix(n, m),
                                  0.1 * Eigen::VectorXd::Ones(m) + matrix(m, 1).cwiseAbs(),
                                  {}};
    const Eigen::VectorXd dependent = machine.directions * matrix(m, 1);
    const State start{0, 3 * matrix(n, 1), matrix(n, 1)};
    expect_same<EventDriven<>>(machine, with_direction(machine, dependent, 0), start, 5);
    expect_same<Adaptive>(machine, with_direction(machine, dependent, 0), start, 5);
  }
}

TEST(SwitchedOff, AMachineWithoutAnyFrictionSwingsForEver) {
  LinearMachine<> machine = two_masses();
  machine.damping.setZero();
  machine.friction_N.setZero();
  const State start{0, Eigen::Vector2d{1, 1}, Eigen::Vector2d{0, 0}};
  EXPECT_NEAR(EventDriven<>(machine).run(start, 10).end.q[0], std::cos(10.0), 1e-13);
  EXPECT_NEAR(Adaptive(machine).run(start, 10).end.q[1], std::cos(10.0), 1e-11);
}

}  // namespace
}  // namespace switched_off_test
