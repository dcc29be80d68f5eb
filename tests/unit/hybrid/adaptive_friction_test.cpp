// The adaptive method under friction laws, against references of many digits and by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "adaptive_machines.hpp"
#include "reference_motion.hpp"

namespace breakaway::hybrid::adaptive_friction_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

ReferenceMotion read_reference(const std::string& name) {
  return read_reference_motion("friction_law_machine.csv", name);
}

double error_of(const ReferenceMotion& reference, const Adaptive& adaptive, const State& start, double end_s) {
  std::vector<Event> log;
  const auto outcome = adaptive.run(start, end_s, &log);
  const double error = largest_error(reference, log, outcome.end);
  std::printf("error %.1e in %zu events, %llu steps\n", error, log.size(),
              static_cast<unsigned long long>(outcome.steps));
  return error;
}

// Measured: 5e-13. A limit that gives way 1e-12 late, at a rate of some N/s, and steps of 1e-12.
TEST(Adaptive, FollowsFallingFrictionThroughSticksAndSlips) {
  const Adaptive adaptive(stribeck_machine(), stribeck_laws());
  EXPECT_LT(error_of(read_reference("stribeck"), adaptive, stribeck_start(), 12), tolerance);
}

// What a user pays for accuracy: the error stays within a hundred times the tolerance, and looser ones take fewer
// steps.
TEST(Adaptive, ErrsByItsTolerance) {
  const ReferenceMotion reference = read_reference("stribeck");
  std::uint64_t steps = 0;
  for (const double step_tolerance : {1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14}) {
    const Adaptive adaptive(stribeck_machine(), stribeck_laws(), {.tolerance = step_tolerance});
    EXPECT_LT(error_of(reference, adaptive, stribeck_start(), 12), 100 * std::max(step_tolerance, 1e-14));
    const auto taken = adaptive.run(stribeck_start(), 12).steps;
    EXPECT_GE(taken, steps);
    steps = taken;
  }
}

TEST(Adaptive, FollowsFrictionInTimeAndPositionOnAJoint) {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d{{1, 0.25}, {0.25, 1}};
  machine.damping = Eigen::Matrix2d{{0.125, 0}, {0, 0.0625}};
  machine.stiffness = Eigen::Matrix2d{{2, -1}, {-1, 3}};
  machine.force_N = Eigen::Vector2d{0.5, -0.25};
  machine.directions = Eigen::Matrix2d{{1, 0}, {-1, 1}};
  machine.friction_N = Eigen::Vector2d::Zero();
  std::vector<model::ShapePtr> parts;
  parts.push_back(model::shape::stribeck(0.5));
  parts.push_back(model::shape::sine_in_time(4));
  const Adaptive adaptive(machine,
                          {{model::FrictionBounds{0.25, 0.75}, model::shape::mean({0.5, 0.5}, std::move(parts))},
                           {model::FrictionBounds{0.125, 0.25}, model::shape::sine_in_position(0.5)}});
  EXPECT_LT(error_of(read_reference("drawn_joint"), adaptive, {0, Eigen::Vector2d{2, -1}, Eigen::Vector2d{0, 1}}, 8),
            tolerance);
}

TEST(Adaptive, MirroredStartsMoveMirroredToTheLastBit) {
  const Adaptive adaptive(stribeck_machine(), stribeck_laws());
  auto mirrored = stribeck_start();
  mirrored.q *= -1;
  mirrored.v *= -1;
  std::vector<Event> log, mirrored_log;
  const auto end = adaptive.run(stribeck_start(), 12, &log).end;
  const auto mirrored_end = adaptive.run(mirrored, 12, &mirrored_log).end;
  EXPECT_EQ(end.q, -mirrored_end.q);
  EXPECT_EQ(end.v, -mirrored_end.v);
  ASSERT_EQ(log.size(), mirrored_log.size());
  for (std::size_t i = 0; i < log.size(); ++i) EXPECT_EQ(log[i].time_s, mirrored_log[i].time_s);
}

// Two machines in one that do not know of each other: what stops and slips at once must not disturb either.
TEST(Adaptive, TwinsStickAndSlipTogether) {
  LinearMachine<> twins;
  twins.mass = twins.directions = Eigen::Matrix2d::Identity();
  twins.damping = Eigen::Matrix2d{{0.125, 0}, {0, 0.125}};
  twins.stiffness = Eigen::Matrix2d{{2, 0}, {0, 2}};
  twins.friction_N = Eigen::Vector2d::Zero();
  const model::FrictionLaw law{model::FrictionBounds{0.1, 0.5}, model::shape::stribeck(0.3)};
  std::vector<Event> log;
  const auto outcome = Adaptive(twins, {law, law}).run({0, Eigen::Vector2d{3, 3}, Eigen::Vector2d{0, 0}}, 60, &log);
  EXPECT_EQ(outcome.verdict, Verdict::at_rest);
  EXPECT_NEAR(outcome.end.q[0], outcome.end.q[1], 1e-13);
  ASSERT_EQ(log.size() % 2, 0U);
  for (std::size_t i = 0; i < log.size(); i += 2) {
    EXPECT_EQ(log[i].kind, log[i + 1].kind);
    EXPECT_NEAR(log[i].time_s, log[i + 1].time_s, 1e-12);
  }
}

// Sticking directions are exact constraints: whatever else moves, their coordinate stays to the last digits.
TEST(Adaptive, StickingDirectionsDoNotDrift) {
  LinearMachine<> machine = two_masses();
  const model::FrictionLaw strong{model::FrictionBounds{5, 10}, model::shape::stribeck(0.3)};
  const model::FrictionLaw weak{model::FrictionBounds{0.001, 0.002}, model::shape::stribeck(0.3)};
  machine.damping.setZero();
  machine.directions = Eigen::Matrix2d{{1, 0}, {-1, 1}};
  const Adaptive adaptive(machine, {strong, weak});
  const auto outcome = adaptive.run({0, Eigen::Vector2d{0.75, 0.25}, Eigen::Vector2d{1, 1}}, 200);
  EXPECT_GT(outcome.steps, 100U);
  EXPECT_NEAR(outcome.end.q[0] - outcome.end.q[1], 0.5, 1e-14);
  EXPECT_NEAR(outcome.end.v[0], outcome.end.v[1], 1e-15);
}

// The spring needs 1 N; friction swings between 0.5 N and 2 N, so that it lets go in the end, at a level of 1 N.
TEST(Adaptive, WaitsUntilFrictionInTimeLetsGo) {
  LinearMachine<> machine;
  machine.mass = machine.directions = machine.stiffness = MatrixXd::Identity(1, 1);
  machine.damping = MatrixXd::Zero(1, 1);
  machine.friction_N = VectorXd::Zero(1);
  const model::FrictionLaw law{model::FrictionBounds{0.5, 2}, model::shape::sine_in_time(0.5)};
  std::vector<Event> log;
  const Adaptive adaptive(machine, {law});
  adaptive.run({0, VectorXd::Constant(1, 1), VectorXd::Zero(1)}, 20, &log);
  ASSERT_FALSE(log.empty());
  EXPECT_EQ(log[0].kind, EventKind::slip);
  // 0.5 + 1.5 (1 + sin(t / 2)) / 2 = 1: sin(t / 2) = -1/3, after pi.
  EXPECT_NEAR(log[0].time_s, 2 * (std::numbers::pi + std::asin(1.0 / 3)), 1e-11);
  // Within the lower bound nothing can let go; beyond it rest is not said to last.
  EXPECT_EQ(adaptive.run({0, VectorXd::Constant(1, 0.4), VectorXd::Zero(1)}, 20).verdict, Verdict::at_rest);
  EXPECT_EQ(adaptive.run({0, VectorXd::Constant(1, 0.6), VectorXd::Zero(1)}, 5).verdict, Verdict::undecided);
}

// A static level of 2 N and a kinetic one of 1 N: the second mass, which needs 1.5 N, must not be let go when the first
// one is.
TEST(Adaptive, StaticFrictionHoldsBesideADirectionThatSlips) {
  LinearMachine<> machine = two_masses();
  machine.stiffness = Eigen::Matrix2d::Identity();
  machine.damping.setZero();
  const model::FrictionLaw law{model::FrictionBounds{1, 2}, model::shape::static_kinetic(1, 0)};
  std::vector<Event> log;
  const auto outcome =
      Adaptive(machine, {law, law}).run({0, Eigen::Vector2d{2.5, 1.5}, Eigen::Vector2d{0, 0}}, 60, &log);
  EXPECT_EQ(outcome.verdict, Verdict::at_rest);
  EXPECT_EQ(outcome.end.q[1], 1.5);
  EXPECT_NEAR(outcome.end.q[0], -0.5, 1e-13);  // half a period about 1 N / (1 N/m), as for constant friction
  EXPECT_NEAR(outcome.settling_time_s, std::numbers::pi, 1e-12);
}

}  // namespace
}  // namespace breakaway::hybrid::adaptive_friction_test
