// The event-driven method where numbers are extreme: each case holds the error that it states, or is refused by name.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "breakaway/hybrid/event_driven.hpp"

namespace extremes_test {
namespace {

using breakaway::hybrid::Event;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::EventKind;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Outcome;
using breakaway::hybrid::Verdict;

constexpr double pi = std::numbers::pi;

struct Trace {
  Outcome<Eigen::Dynamic> outcome;
  std::vector<Event> log;
};

// One instantiation for all cases keeps the compiler's work small.
Trace run(const LinearMachine<>& machine, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double end_time_s,
          double start_time_s = 0) {
  Trace result;
  result.outcome = EventDriven<>(machine).run({start_time_s, q, v}, end_time_s, &result.log);
  return result;
}

LinearMachine<> independent(const Eigen::VectorXd& mass, const Eigen::VectorXd& damping,
                            const Eigen::VectorXd& stiffness, const Eigen::VectorXd& friction_N) {
  LinearMachine<> machine;
  machine.mass = mass.asDiagonal();
  machine.damping = damping.asDiagonal();
  machine.stiffness = stiffness.asDiagonal();
  machine.directions = Eigen::MatrixXd::Identity(mass.size(), mass.size());
  machine.friction_N = friction_N;
  return machine;
}

LinearMachine<> oscillator(double mass, double damping, double stiffness, double friction_N) {
  return independent(Eigen::VectorXd::Constant(1, mass), Eigen::VectorXd::Constant(1, damping),
                     Eigen::VectorXd::Constant(1, stiffness), Eigen::VectorXd::Constant(1, friction_N));
}

Eigen::VectorXd one(double value) { return Eigen::VectorXd::Constant(1, value); }

LinearMachine<> two_masses(double scale = 1) {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = (Eigen::Matrix2d{} << 0.125, 0.375, 0.375, 0.125).finished();
  machine.stiffness = (Eigen::Matrix2d{} << 2, -1, -1, 2).finished();
  machine.directions = Eigen::Matrix2d::Identity();
  machine.friction_N = Eigen::Vector2d{scale, scale};
  return machine;
}

void expect_scaled(const Trace& run, const Trace& other, double state, double time) {
  EXPECT_EQ(run.outcome.verdict, other.outcome.verdict);
  ASSERT_EQ(run.log.size(), other.log.size());
  for (std::size_t i = 0; i < run.log.size(); ++i) {
    EXPECT_EQ(run.log[i].kind, other.log[i].kind);
    EXPECT_EQ(run.log[i].direction, other.log[i].direction);
    EXPECT_DOUBLE_EQ(run.log[i].time_s * time, other.log[i].time_s);
  }
  for (Eigen::Index i = 0; i < run.outcome.end.q.size(); ++i) {
    EXPECT_EQ(run.outcome.end.q[i] * state, other.outcome.end.q[i]);
  }
}

TEST(Extremes, ScalingByAPowerOfTwoScalesEveryBit) {
  const Trace reference = run(two_masses(), Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 0}, 60);
  for (const int k : {-900, -300, -40, -1, 1, 40, 300, 900}) {
    const double scale = std::ldexp(1.0, k);
    expect_scaled(reference, run(two_masses(scale), Eigen::Vector2d{2.5, -1} * scale, Eigen::Vector2d{0, 0}, 60), scale,
                  1);
  }
}

TEST(Extremes, MirroringMirrorsEveryBit) {
  const Trace reference = run(two_masses(), Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0.25, 1}, 60);
  expect_scaled(reference, run(two_masses(), Eigen::Vector2d{-2.5, 1}, Eigen::Vector2d{-0.25, -1}, 60), -1, 1);
}

// t -> 4^k t with M -> 16^k M, C -> 4^k C.
TEST(Extremes, ScalingTimeScalesTheEvents) {
  const Trace reference = run(two_masses(), Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 0}, 60);
  for (const int k : {-60, -20, 1, 20, 60}) {
    const double time = std::ldexp(1.0, 2 * k);
    LinearMachine<> machine = two_masses();
    machine.mass *= time * time;
    machine.damping *= time;
    const Trace other = run(machine, Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 0}, 60 * time);
    ASSERT_EQ(reference.log.size(), other.log.size()) << k;
    for (std::size_t i = 0; i < reference.log.size(); ++i) {
      EXPECT_NEAR(other.log[i].time_s / time / reference.log[i].time_s, 1, 1e-14);
    }
    EXPECT_NEAR(other.outcome.end.q[0] / reference.outcome.end.q[0], 1, 1e-12);
  }
}

// An undamped oscillator loses 2 f / k of amplitude in each half period, and stops in [-f/k, f/k].
TEST(Extremes, FrictionOfAnySizeStopsAnUndampedOscillatorInClosedForm) {
  for (const double friction_N : {1e-300, 1e-150, 1e-12, 1.0, 1e12, 1e150, 1e300}) {
    const Trace r = run(oscillator(1, 0, 1, friction_N), one(8.5 * friction_N), one(0), 100);
    EXPECT_EQ(r.outcome.verdict, Verdict::at_rest) << friction_N;
    EXPECT_NEAR(r.outcome.end.time_s, 4 * pi, 1e-14) << friction_N;
    EXPECT_NEAR(r.outcome.end.q[0] / friction_N, 0.5, 1e-13) << friction_N;
    EXPECT_EQ(r.outcome.events, 4U);
  }
}

TEST(Extremes, MassAndStiffnessOfAnyRatioKeepThePeriod) {
  for (const double ratio : {1e-12, 1e-6, 1.0, 1e6, 1e12}) {
    const Trace r = run(oscillator(ratio, 0, 1 / ratio, 1), one(4.5 * ratio), one(0), 1e30);
    EXPECT_EQ(r.outcome.verdict, Verdict::at_rest);
    EXPECT_NEAR(r.outcome.end.time_s / ratio, 2 * pi, 1e-14);
    EXPECT_NEAR(r.outcome.end.q[0] / ratio, 0.5, 1e-13);
  }
}

// Two oscillators that do not touch each other, one 1e12 times stiffer: each as if alone.
TEST(Extremes, StiffAndSoftSideBySideDoNotDisturbEachOther) {
  for (const double stiffness : {1e-12, 1e12}) {
    const double omega = std::sqrt(stiffness);
    const Trace r = run(
        independent(Eigen::Vector2d{1, 1}, Eigen::Vector2d{0, 0}, Eigen::Vector2d{1, stiffness}, Eigen::Vector2d{1, 1}),
        Eigen::Vector2d{4.5, 2.5 / stiffness}, Eigen::Vector2d{0, 0}, 1e30);
    EXPECT_EQ(r.outcome.verdict, Verdict::at_rest);
    EXPECT_NEAR(r.outcome.end.time_s, std::max(2 * pi, pi / omega), 1e-13 * std::max(1.0, 1 / omega));
    EXPECT_NEAR(r.outcome.end.q[0], 0.5, 1e-13);
    EXPECT_NEAR(r.outcome.end.q[1] * stiffness, -0.5, 1e-13);
  }
}

// Friction levels 1e600 apart in one machine: the weak direction as if alone.
TEST(Extremes, WeakAndStrongFrictionSideBySide) {
  const Trace r =
      run(independent(Eigen::Vector2d{1, 1}, Eigen::Vector2d{0, 0}, Eigen::Vector2d{1, 1}, Eigen::Vector2d{1e-200, 1}),
          Eigen::Vector2d{4.5e-200, 2.5}, Eigen::Vector2d{0, 0}, 100);
  EXPECT_EQ(r.outcome.verdict, Verdict::at_rest);
  EXPECT_NEAR(r.outcome.end.q[0] / 1e-200, 0.5, 1e-13);
  EXPECT_NEAR(r.outcome.end.time_s, 2 * pi, 1e-14);
}

// Overdamped by 1e8 against a constant friction: x' decays as e^(-k t / c), and the mass never gets to the edge of the
// equilibrium set, which is c/k ln 2 away in time only after the transient.
TEST(Extremes, DampingRatiosFromNearOneToHuge) {
  for (const double zeta : {1 - 1e-12, 1 - 1e-6, 1.0, 1 + 1e-12, 1 + 1e-6, 1.5, 1e4, 1e8}) {
    // Released with velocity 0 at q = 3 f / k: slides towards the edge f / k and approaches it without stopping.
    const Trace r = run(oscillator(1, 2 * zeta, 1, 1), one(3), one(0), 2 * zeta);
    const long double z = zeta, t = 2 * z;
    const long double w = std::sqrt(std::abs((z - 1) * (z + 1))), small = 1 / (z + w), large = z + w;
    long double y = 0;
    if (w < 1e-3L) {  // (1 + z t) e^-zt, with the next order in w^2
      const long double s = (z > 1 ? 1 : -1) * w * w * t * t;
      y = 2 * std::exp(-z * t) * ((1 + s / 2) + z * t * (1 + s / 6));
    } else if (z < 1) {
      y = 2 * std::exp(-z * t) * (std::cos(w * t) + z / w * std::sin(w * t));
    } else {
      y = 2 * (large * std::exp(-small * t) - small * std::exp(-large * t)) / (large - small);
    }
    EXPECT_EQ(r.outcome.events, 0U) << zeta;
    EXPECT_NEAR(r.outcome.end.q[0], static_cast<double>(1 + y), 1e-13) << zeta;
  }
}

// Without spring and damper: v falls by f / m each second.
TEST(Extremes, FreeMassStopsInClosedForm) {
  const Trace r = run(oscillator(2, 0, 0, 0.5), one(1e6), one(3), 1e9);
  EXPECT_EQ(r.outcome.verdict, Verdict::at_rest);
  EXPECT_NEAR(r.outcome.end.time_s, 12, 1e-13);
  EXPECT_NEAR(r.outcome.end.q[0] - 1e6, 18, 1e-9);  // of 1e6
}

// Masses of 1 kg without springs, which dampers, constant forces and one direction of 0.25 N act on. While it slides,
// each speed goes to that at which its damper takes its force, however slowly the sum in the direction gets to zero.
struct DampedMasses {
  Eigen::Vector3d damping, force_N, direction, v;

  LinearMachine<> machine() const {
    LinearMachine<> result = independent(Eigen::Vector3d::Ones(), damping, Eigen::Vector3d::Zero(), one(0.25));
    result.directions = direction;
    result.force_N = force_N;
    return result;
  }
  Eigen::Vector3d sliding_velocity(double t) const {
    const double sign = direction.dot(v) > 0 ? 1 : -1;
    const Eigen::Vector3d last = (force_N - 0.25 * sign * direction).cwiseQuotient(damping);
    return last + (-damping * t).array().exp().matrix().cwiseProduct(v - last);
  }
  // Says when the direction stops, between two instants.
  double stop_s(double moving_s, double stopped_s) const {
    const double sign = direction.dot(v) > 0 ? 1 : -1;
    for (int halving = 0; halving < 60; ++halving) {
      const double middle_s = (moving_s + stopped_s) / 2;
      (sign * direction.dot(sliding_velocity(middle_s)) > 0 ? moving_s : stopped_s) = middle_s;
    }
    return stopped_s;
  }
};

TEST(Extremes, ASpeedThatDriftsSlowlyToZeroStops) {
  const struct {
    DampedMasses masses;
    double before_s, behind_s;
  } cases[] = {{{{2.25, 3, 2}, {-0.25, -0.25, -0.75}, {2, 1.5, 1.5}, {-1.5, 1.75, -1.5}}, 3.3, 3.5},
               {{{3, 1.5, 4}, {0, 0.75, 2}, {-1, 1, -0.5}, {1.75, 1.75, -0.75}}, 2.9, 3.1},
               {{{2.75, 1.75, 3}, {1.25, -1, -2}, {1.5, -0.5, 1}, {1.75, -1.75, 1.75}}, 2.1, 2.3}};
  for (const auto& c : cases) {
    const Trace r = run(c.masses.machine(), Eigen::Vector3d::Zero(), c.masses.v, 20);
    ASSERT_FALSE(r.log.empty());
    EXPECT_NEAR(r.log.front().time_s, c.masses.stop_s(c.before_s, c.behind_s), 1e-13);
  }
}

// The direction stops where the constant forces equal its friction, and dampers that are all alike leave it so: it may
// stick or slide without speed, and either is followed at the pace at which the others move.
TEST(Extremes, AForceThatEqualsFrictionForEverIsFollowedInFewSteps) {
  const DampedMasses masses{{1.5, 1.5, 1.5}, {1.25, 0.75, -0.5}, {-0.5, 1, -1.5}, {1.25, 1.25, 0.75}};
  const double stop_s = masses.stop_s(0.2, 0.3);
  const Eigen::Vector3d last = (masses.force_N - 0.25 * masses.direction) / 1.5;
  const Trace r = run(masses.machine(), Eigen::Vector3d::Zero(), masses.v, 20);
  const Eigen::Vector3d v = last + std::exp(-1.5 * (20 - stop_s)) * (masses.sliding_velocity(stop_s) - last);
  EXPECT_LT((r.outcome.end.v - v).norm(), 1e-14);
  EXPECT_LT(r.outcome.work, 1e6);
}

TEST(Extremes, SingularAndNearlySingularStiffness) {
  for (const double k : {0.0, 1e-300, 1e-30, 1e-15, -1e-15}) {
    LinearMachine<> machine = two_masses();
    machine.damping.setZero();
    machine.stiffness = (Eigen::Matrix2d{} << 1 + k, -1, -1, 1 + k).finished();
    // Both masses move together: the spring between them is idle, and each decelerates at 1 m/s^2.
    const Trace r = run(machine, Eigen::Vector2d{0, 0}, Eigen::Vector2d{2, 2}, 100);
    EXPECT_EQ(r.outcome.verdict, Verdict::at_rest) << k;
    EXPECT_NEAR(r.outcome.end.time_s, 2, 1e-14) << k;
    EXPECT_NEAR(r.outcome.end.q[0], 2, 1e-14) << k;
    EXPECT_NEAR(r.outcome.end.q[1], 2, 1e-14) << k;
  }
}

TEST(Extremes, RepeatedEigenvaluesAndSingularDamping) {
  for (const int size : {2, 5}) {
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(size), zeros = Eigen::VectorXd::Zero(size);
    const Trace r = run(independent(ones, zeros, ones, ones), 4.5 * ones, zeros, 100);
    EXPECT_EQ(r.outcome.verdict, Verdict::at_rest);
    EXPECT_NEAR(r.outcome.end.time_s, 2 * pi, 1e-14);
    for (const double q : r.outcome.end.q) EXPECT_NEAR(q, 0.5, 1e-13);
  }
}

// A Jordan block of size four: q1 drives q2 and both have the same frequency.
TEST(Extremes, DefectiveModesAreSummedAsSeries) {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = Eigen::Matrix2d::Zero();
  machine.stiffness = (Eigen::Matrix2d{} << 1, 0, -1, 1).finished();
  machine.directions = Eigen::Vector2d{1, 0};
  machine.friction_N = one(0);
  const double t = 10;
  const Trace r = run(machine, Eigen::Vector2d{1, 0}, Eigen::Vector2d{0, 0}, t);
  EXPECT_NEAR(r.outcome.end.q[0], std::cos(t), 1e-13);
  EXPECT_NEAR(r.outcome.end.q[1], t * std::sin(t) / 2, 1e-13);
}

TEST(Extremes, DependentDirectionsShareTheirForce) {
  // The same joint, as one of 1 N and as three of 1 N together.
  LinearMachine<> one_joint = oscillator(1, 0.25, 1, 1), three_joints = one_joint;
  three_joints.directions = Eigen::RowVector3d{1, -1, 1};
  three_joints.friction_N = Eigen::Vector3d{0.25, 0.5, 0.25};
  const Trace r = run(one_joint, one(8.5), one(0), 100), other = run(three_joints, one(8.5), one(0), 100);
  EXPECT_EQ(other.outcome.verdict, Verdict::at_rest);
  EXPECT_NEAR(r.outcome.end.time_s, other.outcome.end.time_s, 1e-14);
  EXPECT_NEAR(r.outcome.end.q[0], other.outcome.end.q[0], 1e-14);
  EXPECT_EQ(other.log.size(), 3 * r.log.size());
}

TEST(Extremes, TieAtTheStaticLimitStays) {
  for (const double q : {1.0, -1.0, std::nextafter(1.0, 0.0)}) {
    const Trace r = run(oscillator(1, 0, 1, 1), one(q), one(0), 1e300);
    EXPECT_EQ(r.outcome.verdict, Verdict::at_rest) << q;
    EXPECT_EQ(r.outcome.end.q[0], q);
  }
}

// The second mass is stuck exactly at its limit while the first moves: it gives way if pushed further, else holds.
TEST(Extremes, TieAtTheStaticLimitIsDecidedByTheForcesDerivative) {
  LinearMachine<> machine = two_masses();
  machine.damping.setZero();
  const Trace pushed = run(machine, Eigen::Vector2d{1, 0}, Eigen::Vector2d{2, 0}, 0.5);
  const Trace relieved = run(machine, Eigen::Vector2d{1, 0}, Eigen::Vector2d{-2, 0}, 0.5);
  EXPECT_GT(pushed.outcome.end.v[1], 0);
  EXPECT_EQ(relieved.outcome.end.v[1], 0);
}

TEST(Extremes, StartOnASwitchingSurface) {
  const Trace r = run(two_masses(), Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 1}, 60);
  const Trace beside = run(two_masses(), Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{-1e-13, 1}, 60);
  ASSERT_EQ(r.log.size(), beside.log.size());
  EXPECT_NEAR(r.outcome.end.q[0], beside.outcome.end.q[0], 1e-12);
}

TEST(Extremes, DenormalStartsAreAtRestOrKeepTheirSymmetry) {
  const double least = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(run(oscillator(1, 0, 1, 1), one(least), one(-least), 1).outcome.verdict, Verdict::at_rest);
  const Trace r = run(oscillator(1, 0, 1, 1e-310), one(8.5e-310), one(0), 100);
  EXPECT_EQ(r.outcome.verdict, Verdict::at_rest);
  EXPECT_NEAR(r.outcome.end.time_s, 4 * pi, 1e-12);  // 1e-310 itself has 14 digits
}

TEST(Extremes, HugeTimes) {
  const Trace damped =
      run(independent(Eigen::Vector2d{1, 1}, Eigen::Vector2d{1, 1}, Eigen::Vector2d{1, 1}, Eigen::Vector2d{1, 0}),
          Eigen::Vector2d{0.5, 3}, Eigen::Vector2d{0, 0}, 1e300);
  EXPECT_EQ(damped.outcome.verdict, Verdict::captured);  // the second mass has no friction: it settles, but never ends
  EXPECT_NEAR(damped.outcome.end.q[1], 0, 1e-15);
  const Trace undamped =
      run(independent(Eigen::Vector2d{1, 1}, Eigen::Vector2d{0, 0}, Eigen::Vector2d{1, 1}, Eigen::Vector2d{1, 0}),
          Eigen::Vector2d{0.5, 3}, Eigen::Vector2d{0, 0}, 1e300);
  EXPECT_EQ(undamped.outcome.verdict, Verdict::lost);
  const Trace late = run(two_masses(), Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 0}, 1e9 + 60, 1e9);
  EXPECT_NEAR(late.outcome.end.time_s - 1e9, 7.297349020148677, 1e-7);
  EXPECT_NEAR(late.outcome.end.q[0], 0.017809969191895765, 1e-13);
}

TEST(Extremes, UnstableMachineGrowsAsItsEigenvalueSays) {
  // v = 1 at the start, no friction worth speaking of: q = sinh(t).
  const Trace r = run(oscillator(1, 0, -1, 1e-200), one(0), one(1), 100);
  EXPECT_NEAR(r.outcome.end.q[0] / std::sinh(100.0), 1, 1e-13);
}

// With C >= 0 every joule that the springs and masses lose goes to friction and dampers.
TEST(Extremes, EnergyNeverRisesOfPassiveMachines) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 40; ++trial) {
    const Eigen::Index n = 2 + trial % 3, m = 1 + trial % 4;
    const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
      return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); }).eval();
    };
    const auto positive = [&](double least) {
      const Eigen::MatrixXd root = matrix(n, n);
      return Eigen::MatrixXd{root * root.transpose() + least * Eigen::MatrixXd::Identity(n, n)};
    };
    LinearMachine<> machine{positive(0.1), positive(0), positive(0.1), matrix(n, m), matrix(m, 1).cwiseAbs() * 0.3, {}};
    machine.mass = (machine.mass + machine.mass.transpose()).eval() / 2;
    machine.stiffness = (machine.stiffness + machine.stiffness.transpose()).eval() / 2;
    const MachineState<Eigen::Dynamic> start{0, matrix(n, 1) * 3, matrix(n, 1)};
    double energy_J = breakaway::stability::energy_J(machine, start);
    int rises = 0;
    const auto outcome = EventDriven<>(machine).run(start, 50, nullptr, [&](const auto& state) {
      const double now_J = breakaway::stability::energy_J(machine, state);
      if (now_J > energy_J * (1 + 1e-12)) ++rises;
      energy_J = now_J;
    });
    EXPECT_EQ(rises, 0) << "trial " << trial;
    EXPECT_NE(outcome.verdict, Verdict::lost) << "trial " << trial;
  }
}

// Dependent directions included: what is left of the motion may not depend on where it was cut in two.
TEST(Extremes, RestartingMidwayChangesNothing) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return uniform(random); }).eval();
  };
  for (int trial = 0; trial < 60; ++trial) {
    const Eigen::Index n = 2 + trial % 3, m = 1 + trial % 4;
    const Eigen::MatrixXd root = matrix(n, n);
    LinearMachine<> machine{Eigen::MatrixXd::Identity(n, n), 0.1 * matrix(n, n),
                            root * root.transpose(),         matrix(n, m),
                            matrix(m, 1).cwiseAbs(),         {}};
    const Eigen::VectorXd q = 3 * matrix(n, 1), v = matrix(n, 1);
    const Trace whole = run(machine, q, v, 5), first = run(machine, q, v, 2.3125);
    const Trace second = run(machine, first.outcome.end.q, first.outcome.end.v, 5, 2.3125);
    EXPECT_LT((whole.outcome.end.q - second.outcome.end.q).norm(), 1e-12) << "trial " << trial;
    EXPECT_LT((whole.outcome.end.v - second.outcome.end.v).norm(), 1e-12) << "trial " << trial;
  }
}

// What is said where the call is refused.
template <class Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

TEST(Extremes, WhatCannotBeFollowedIsRefusedByName) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_NE(message([&] { run(oscillator(1, 0, 1, infinite), one(1), one(0), 1); }).find("friction_N"),
            std::string::npos);
  EXPECT_NE(message([&] { run(oscillator(0, 0, 1, 1), one(1), one(0), 1); }).find("mass"), std::string::npos);
  EXPECT_NE(message([&] { run(oscillator(1, 0, 1, 1e-300), one(1e300), one(0), 1); }).find("start"), std::string::npos);
  EXPECT_NE(message([&] {
              run(oscillator(1, 0, 1, 1), Eigen::Vector2d{1, 1}, one(0), 1);
            }).find("coordinates"),
            std::string::npos);
  EXPECT_NE(message([&] { run(oscillator(1, 0, -1, 1), one(2), one(1), 1e6); }).find("largest number"),
            std::string::npos);
  EXPECT_NE(message([&] { run(oscillator(1, 0, 1, 1), one(1), one(0), NAN); }).find("end"), std::string::npos);
}

// A machine of a coupled node that was certified and could not be simulated: nothing but dampers joins its coordinates.
TEST(Extremes, WhatNoSpringHoldsIsRefusedWithASpringThatWouldDo) {
  LinearMachine<> machine;
  machine.mass = Eigen::Vector3d{0.02067717300336152, 0.02750186458667253, 0.07319945793174087}.asDiagonal();
  machine.damping = (Eigen::Matrix3d{} << 1.9733482321336464e-05, -3.946696464267293e-05, 0, -1.9733482321336464e-05,
                     0.003926629678898538, -0.007813792393154403, 0, -0.0039068961965772015, 0.0039068961965772015)
                        .finished();
  machine.stiffness = Eigen::Matrix3d::Zero();
  machine.directions = Eigen::Matrix3d::Identity();
  machine.friction_N = Eigen::Vector3d{0.19, 0.19, 0.2};
  const auto follow = [&] { run(machine, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), 1); };
  const std::string refusal = message(follow);
  EXPECT_NE(refusal.find("give each coordinate that no spring holds a weak one"), std::string::npos) << refusal;
  machine.stiffness = 1e-6 * machine.mass;
  EXPECT_NO_THROW(follow());
}

}  // namespace
}  // namespace extremes_test
