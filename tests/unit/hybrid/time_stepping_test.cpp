#include "breakaway/hybrid/time_stepping.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "../refusal.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/hybrid/impulsive_stepping.hpp"

namespace breakaway::hybrid::time_stepping_test {
namespace {

using Oscillator = LinearMachine<>;  // of one coordinate
using TwoMasses = LinearMachine<2, 2>;

Oscillator oscillator(double damping, double friction_N) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  return {one, damping * one, one, one, friction_N * one, {}};
}

// Section 4 of van de Wouw & Leine (stability properties of equilibrium sets).
TwoMasses two_masses() {
  TwoMasses m;
  m.mass.setIdentity();
  m.damping << 0.125, 0.375, 0.375, 0.125;
  m.stiffness << 2, -1, -1, 2;
  m.directions.setIdentity();
  m.friction_N << 1, 1;
  return m;
}

template <int N>
MachineState<N> at_rest(const Eigen::Matrix<double, N, 1>& q) {
  MachineState<N> state;
  state.q = q;
  state.v = q;
  state.v.setZero();
  return state;
}

MachineState<Eigen::Dynamic> released_from(double q_m) {
  return at_rest<Eigen::Dynamic>(Eigen::VectorXd::Constant(1, q_m));
}

// m q'' + k q = -f Sign(q'), m = k = 1: every half turn takes pi and 2 f off the amplitude. From 4.3 with f = 0.5 the
// axis comes to rest at 0.3 after four of them.
TEST(TimeStepping, ConvergesToTheClosedFormInTheFirstOrder) {
  const Oscillator machine = oscillator(0, 0.5);
  double before = 1;
  for (const double step_s : {1e-2, 1e-3, 1e-4}) {
    const auto outcome = TimeStepping<>{machine, {.step_s = step_s}}.run(released_from(4.3), 60);
    EXPECT_EQ(outcome.verdict, Verdict::at_rest);
    const double error = std::fabs(outcome.end.q[0] - 0.3);
    EXPECT_LT(error, 4 * step_s);  // four stops, each late by less than a step at an acceleration of order one
    EXPECT_NEAR(outcome.settling_time_s, 4 * std::numbers::pi, 5 * step_s);
    EXPECT_LT(error, before / 3) << step_s;
    before = error;
  }
}

// Without friction and damping V = (v^2 + q^2) / 2 is constant; the midpoint rule keeps it to rounding, implicit Euler
// divides it by 1 + h^2 a step, explicit Euler multiplies it by that.
TEST(TimeStepping, KeepsTheEnergyWithTheMidpointRuleOnly) {
  const Oscillator machine = oscillator(0, 0);
  const auto energy_after = [&](double theta) {
    return energy_J(machine, TimeStepping<>{machine, {0.1, theta}}.run(released_from(1), 99.95).end);
  };
  EXPECT_NEAR(energy_after(0.5), 0.5, 1e-13);
  EXPECT_NEAR(energy_after(1) / 0.5, std::pow(1.01, -1000), 1e-13);
  EXPECT_NEAR(energy_after(0) / 0.5, std::pow(1.01, 1000), 1e-8);
}

TEST(TimeStepping, LeavesWhatSticksWhereItIsToTheLastBit) {
  const TwoMasses machine = two_masses();
  const TimeStepping<2, 2> stepping{machine};
  const Eigen::Vector2d inside{0.4, -0.1};  // K q = (0.9, -0.6)
  auto state = at_rest<2>(inside);
  auto memory = stepping.memory();
  for (int i = 0; i < 1000; ++i) stepping.step(state, memory);
  EXPECT_EQ(state.q, inside);
  EXPECT_EQ(state.v, Eigen::Vector2d::Zero());
  const auto outcome = stepping.run(at_rest<2>(inside), 60);
  EXPECT_EQ(outcome.verdict, Verdict::at_rest);
  EXPECT_EQ(outcome.settling_time_s, 0);
  EXPECT_EQ(outcome.steps, 1u);
}

// K q = (0.25, 1): exactly on the edge of sticking, on which rounding falls to either side.
TEST(TimeStepping, RestsWhereTheForceEqualsFriction) {
  for (const double h : {1e-1, 1e-2, 1e-3}) {
    const TimeStepping<2, 2> stepping{two_masses(), {.step_s = h}};
    EXPECT_EQ(stepping.run(at_rest<2>({0.5, 0.75}), 1).verdict, Verdict::at_rest) << h;
    EXPECT_EQ(stepping.run(at_rest<2>({-0.5, -0.75}), 1).verdict, Verdict::at_rest) << h;
  }
}

// Random machines of 3 coordinates and 4 directions, dependent therefore: after every step each impulse is at its limit
// against the sliding, or the direction does not slide.
TEST(TimeStepping, SolvesTheInclusionOfDependentDirections) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> number{-1, 1};
  const auto filled = [&](auto matrix) { return matrix.unaryExpr([&](double) { return number(random); }).eval(); };
  int stuck = 0, sliding = 0;
  for (int trial = 0; trial < 50; ++trial) {
    LinearMachine<> machine;
    const Eigen::MatrixXd a = filled(Eigen::MatrixXd(3, 3)), b = filled(Eigen::MatrixXd(3, 3));
    machine.mass = a * a.transpose() + 0.5 * Eigen::MatrixXd::Identity(3, 3);
    machine.mass = (machine.mass + machine.mass.transpose()).eval() / 2;
    machine.damping = filled(Eigen::MatrixXd(3, 3)) / 4;
    machine.stiffness = b * b.transpose();
    machine.directions = filled(Eigen::MatrixXd(3, 4));
    machine.friction_N = filled(Eigen::MatrixXd(4, 1)).cwiseAbs();
    const double h = 0.01;
    const TimeStepping<> stepping{machine, {.step_s = h}};
    auto state = at_rest<Eigen::Dynamic>(Eigen::VectorXd(3 * filled(Eigen::MatrixXd(3, 1))));
    auto memory = stepping.memory();
    for (int i = 0; i < 400; ++i) {
      stepping.step(state, memory);
      const Eigen::VectorXd slides = machine.directions.transpose() * state.v;
      for (Eigen::Index k = 0; k < 4; ++k) {
        const double limit = h * machine.friction_N[k];
        ASSERT_LE(std::fabs(memory.impulse_Ns[k]), limit);
        if (std::fabs(memory.impulse_Ns[k]) < limit) {
          ASSERT_NEAR(slides[k], 0, 1e-9);  // what nearly dependent directions leave after the last sweep
          ++stuck;
        } else if (std::fabs(slides[k]) > 1e-9) {
          ASSERT_LT(slides[k] * memory.impulse_Ns[k], 0);
          ++sliding;
        }
      }
    }
  }
  EXPECT_GT(stuck, 1000);
  EXPECT_GT(sliding, 1000);
}

TEST(TimeStepping, GivesTheSameForFixedAndDynamicSizes) {
  const TwoMasses fixed = two_masses();
  LinearMachine<> dynamic;
  dynamic.mass = fixed.mass, dynamic.damping = fixed.damping, dynamic.stiffness = fixed.stiffness;
  dynamic.directions = fixed.directions, dynamic.friction_N = fixed.friction_N;
  std::vector<Event> log;
  const auto a = TimeStepping<2, 2>{fixed}.run(at_rest<2>({2.5, -1}), 60, &log);
  const auto b = TimeStepping<>{dynamic}.run(at_rest<Eigen::Dynamic>(Eigen::Vector2d{2.5, -1}), 60);
  EXPECT_EQ(a.verdict, Verdict::at_rest);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_LT((a.end.q - b.end.q).norm(), 1e-13);
  EXPECT_EQ(a.events, log.size());
  ASSERT_FALSE(log.empty());
  EXPECT_EQ(log.front().kind, EventKind::slip);
  EXPECT_EQ(log.back().kind, EventKind::stick);
}

// (q, v, f) times a power of two is an exact symmetry: there is no absolute tolerance.
TEST(TimeStepping, ScalesToTheLastBit) {
  const auto reference = TimeStepping<2, 2>{two_masses()}.run(at_rest<2>({2.5, -1}), 60);
  for (int k = -40; k <= 40; k += 8) {
    TwoMasses machine = two_masses();
    const double scale = std::ldexp(1, k);
    machine.friction_N *= scale;
    const auto scaled = TimeStepping<2, 2>{machine}.run(at_rest<2>(scale * Eigen::Vector2d{2.5, -1}), 60);
    EXPECT_EQ(scaled.steps, reference.steps) << k;
    EXPECT_EQ(scaled.end.q, scale * reference.end.q) << k;
  }
}

// From (3.6, -3.6) the anti-phase mode, whose damping is -0.25, grows: 3.6 is beyond the amplitude f / (0.25 ...) that
// friction can hold. Implicit Euler at h = 0.1 brings even that to rest, and warns that it may.
TEST(TimeStepping, WarnsWhereImplicitEulerBringsToRestWhatNeverRests) {
  const TwoMasses machine = two_masses();
  const TimeStepping<2, 2> midpoint{machine, {0.1, 0.5}}, implicit{machine, {0.1, 1}};
  EXPECT_TRUE(midpoint.warning().empty());
  EXPECT_NE(implicit.warning().find("not positive semidefinite"), std::string::npos);
  const auto start = at_rest<2>({3.6, -3.6});
  EXPECT_EQ(midpoint.run(start, 60).verdict, Verdict::undecided);
  EXPECT_GT(midpoint.run(start, 60).end.q.norm(), 100);
  EXPECT_EQ(implicit.run(start, 60).verdict, Verdict::at_rest);
  EXPECT_TRUE((TimeStepping<>{oscillator(0.1, 1), {0.1, 1}}.warning().empty()));
}

TEST(TimeStepping, RefusesByName) {
  const auto refusal = [](const Oscillator& machine, TimeSteppingOptions options) {
    return testing::refusal([&] { TimeStepping<>{machine, options}; });
  };
  EXPECT_NE(refusal(oscillator(0, 1), {0, 0.5}).find("step_s"), std::string::npos);
  EXPECT_NE(refusal(oscillator(0, 1), {std::nan(""), 0.5}).find("step_s"), std::string::npos);
  EXPECT_NE(refusal(oscillator(0, 1), {0.1, 1.5}).find("theta"), std::string::npos);
  EXPECT_NE(refusal(oscillator(0, -1), {0.1, 0.5}).find("friction_N"), std::string::npos);
  EXPECT_NE(refusal(oscillator(-30, 1), {0.1, 0.5}).find("too long"), std::string::npos);
}

// The two-cycle x = +-A h^2 / 8 of x -> x - h/2 sqrt(2 A x).
TEST(ImpulsiveStepping, ReportsTheBallThatItNeverLeaves) {
  const auto law = design::K3<double>::make({1, 1, 3, 2.5});
  const ImpulsivePlant plant{1, 1, 0.5, 3, 2.5, 4.5};
  const auto level_N = [](double t, double, double speed) {
    return 10 * (0.1 / (1 + 0.5 * speed) + 0.3 + 0.05 * std::sin(4 * t));
  };
  for (const double h : {1e-2, 1e-3}) {
    const auto outcome = run_impulsive(plant, -4, -4, h, 8, 12, level_N, [&](double x) { return law.impulse_Ns(x); });
    EXPECT_NEAR(outcome.first_rest_s, 3.5452127, 5 * h);  // t1 by an event-driven computation of 12 digits
    EXPECT_EQ(outcome.predicted_ball_m, 2.5 * h * h / 8);
    // k3 differs from m sqrt(2 A y) by the relative order of h.
    EXPECT_NEAR(outcome.ball_m / outcome.predicted_ball_m, 1, 3 * h);
    EXPECT_GT(static_cast<double>(outcome.late_kicks), 0.95 * static_cast<double>(outcome.late_steps));
  }
}

}  // namespace
}  // namespace breakaway::hybrid::time_stepping_test
