// The adaptive method against the event-driven one and the slide; how it ends, and what it refuses.
#include "breakaway/hybrid/adaptive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "adaptive_machines.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/motion/slide.hpp"

namespace breakaway::hybrid::adaptive_test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

LinearMachine<> one_joint_for_three() {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix3d{{1, 0.25, 0}, {0.25, 1, 0}, {0, 0, 2}};
  machine.damping = Eigen::Matrix3d{{0.125, 0, 0}, {0, 0.25, -0.125}, {0, -0.125, 0.25}};
  machine.stiffness = Eigen::Matrix3d{{2, -1, 0}, {-1, 2, -1}, {0, -1, 2}};
  machine.directions = Eigen::Vector3d{1, -1, 0};
  machine.friction_N = VectorXd::Constant(1, 0.75);
  return machine;
}

LinearMachine<> three_joints_for_two() {
  LinearMachine<> machine = two_masses();
  machine.mass = Eigen::Matrix2d{{1, 0}, {0, 0.5}};
  machine.damping = Eigen::Matrix2d{{0.125, 0}, {0, 0.0625}};
  machine.stiffness = Eigen::Matrix2d{{2, -1}, {-1, 3}};
  machine.directions = MatrixXd{{1, 0, 1}, {0, 1, -1}};
  machine.friction_N = Eigen::Vector3d{0.25, 0.375, 0.5};
  return machine;
}

// The largest difference in event times and in the state at the end.
double difference(const LinearMachine<>& machine, const State& start, double end_s) {
  std::vector<Event> exact_log, log;
  const auto exact = EventDriven<>(machine).run(start, end_s, &exact_log);
  const auto outcome = Adaptive(machine).run(start, end_s, &log);
  EXPECT_EQ(outcome.verdict, exact.verdict);
  EXPECT_EQ(log.size(), exact_log.size());
  double error = (outcome.end.q - exact.end.q).norm() + (outcome.end.v - exact.end.v).norm();
  error = std::max(error, std::abs(outcome.end.time_s - exact.end.time_s));
  for (std::size_t i = 0; i < std::min(log.size(), exact_log.size()); ++i) {
    EXPECT_EQ(log[i].kind, exact_log[i].kind) << i;
    EXPECT_EQ(log[i].direction, exact_log[i].direction) << i;
    error = std::max(error, std::abs(log[i].time_s - exact_log[i].time_s));
  }
  std::printf("difference %.1e in %zu events, %llu steps\n", error, log.size(),
              static_cast<unsigned long long>(outcome.steps));
  return error;
}

TEST(Adaptive, FollowsConstantFrictionAsTheEventDrivenMethodDoes) {
  EXPECT_LT(difference(two_masses(), {0, Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 0}}, 60), tolerance);
  EXPECT_LT(difference(unequal_masses(), {0, Eigen::Vector2d{2, -1.5}, Eigen::Vector2d{0.5, 1}}, 60), tolerance);
  EXPECT_LT(difference(one_joint_for_three(), {0, Eigen::Vector3d{2, -1, 1}, Eigen::Vector3d{0, 1, 0}}, 12), tolerance);
  EXPECT_LT(difference(three_joints_for_two(), {0, Eigen::Vector2d{3, -2}, Eigen::Vector2d{1, 0}}, 60), tolerance);
}

TEST(Adaptive, ConstantForcesShiftTheMachine) {
  auto machine = unequal_masses();
  machine.force_N = Eigen::Vector2d{0.5, -0.25};
  EXPECT_LT(difference(machine, {1, Eigen::Vector2d{2, -1.5}, Eigen::Vector2d{0.5, 1}}, 60), tolerance);
}

struct NamedShape {
  const char* name;
  model::ShapePtr (*make)();
};

model::ShapePtr of_the_example() {
  std::vector<model::ShapePtr> parts;
  parts.push_back(model::shape::stribeck(2));
  parts.push_back(model::shape::sine_in_time(4));
  return model::shape::mean({0.5, 0.5}, std::move(parts));
}

class OneCoordinate : public ::testing::TestWithParam<NamedShape> {};

// Both integrate to rounding by themselves, one on closed forms and its own flights, the other as any machine.
TEST_P(OneCoordinate, MovesAsTheSlideDoes) {
  const model::FrictionLaw law{model::FrictionBounds{0.5, 1.5}, GetParam().make()};
  LinearMachine<> machine;
  machine.mass = machine.directions = MatrixXd::Identity(1, 1);
  machine.damping = MatrixXd::Constant(1, 1, 0.05);
  machine.stiffness = MatrixXd::Constant(1, 1, 4);
  machine.friction_N = VectorXd::Zero(1);
  motion::Slide slide(1, law, {0, 3, -1});
  model::AppliedForce force;
  force.stiffness_N_per_m = 4;
  force.damping_Ns_per_m = 0.05;
  const Adaptive adaptive(machine, {law});
  std::vector<Event> log;
  adaptive.run({0, VectorXd::Constant(1, 3), VectorXd::Constant(1, -1)}, 20, &log);
  for (const double time_s : {0.3, 1.0, 2.5, 4.0, 7.0, 20.0}) {
    slide.advance_to(time_s, force);
    const auto outcome = adaptive.run({0, VectorXd::Constant(1, 3), VectorXd::Constant(1, -1)}, time_s);
    EXPECT_NEAR(outcome.end.q[0], slide.state().position_m, 1e-11) << time_s;
    EXPECT_NEAR(outcome.end.v[0], slide.state().velocity_m_s, 1e-11) << time_s;
  }
  const auto& counters = slide.counters();
  EXPECT_EQ(log.size(), counters.sticks + counters.slips - counters.reversals);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, OneCoordinate,
    ::testing::Values(NamedShape{"constant", [] { return model::shape::constant(0.3); }},
                      NamedShape{"static_kinetic", [] { return model::shape::static_kinetic(1, 0.1); }},
                      NamedShape{"stribeck", [] { return model::shape::stribeck(0.2); }},
                      NamedShape{"stribeck_gaussian", [] { return model::shape::stribeck_gaussian(0.2); }},
                      NamedShape{"sine_in_time", [] { return model::shape::sine_in_time(4); }},
                      NamedShape{"sine_in_position", [] { return model::shape::sine_in_position(0.7, 0.2); }},
                      NamedShape{"position_table",
                                 [] {
                                   return model::shape::position_table({-0.5, 0.25, 1}, {0.2, 1, 0, 0.7});
                                 }},
                      NamedShape{"random_dwell",
                                 [] {
                                   return model::shape::random_dwell(
                                       {.seed = 7, .shortest_dwell_s = 0.05, .longest_dwell_s = 1});
                                 }},
                      NamedShape{"example", of_the_example}),
    [](const auto& shape) { return shape.param.name; });

// The lower bounds keep a certificate's promise: energies inside { V < rho } decide, asked at each step.
TEST(Adaptive, EndsOnTheCallersDecision) {
  const auto machine = stribeck_machine();
  const Adaptive adaptive(machine, stribeck_laws(), {}, [&](const State& state) {
    return stability::energy_J(machine, state) < 1 ? Verdict::captured : Verdict::undecided;
  });
  const auto outcome = adaptive.run(stribeck_start(), 60);
  EXPECT_EQ(outcome.verdict, Verdict::captured);
  EXPECT_LT(stability::energy_J(machine, outcome.end), 1);
}

std::string refusal(const LinearMachine<>& machine, const Adaptive::Laws& laws, double tolerance_of_steps) {
  return breakaway::testing::refusal([&] { Adaptive(machine, laws, {.tolerance = tolerance_of_steps}); });
}

TEST(Adaptive, RefusesByName) {
  auto machine = stribeck_machine();
  EXPECT_NE(refusal(machine, {stribeck_laws()[0]}, 1e-12).find("1 friction laws for 2"), std::string::npos);
  EXPECT_NE(refusal(machine, stribeck_laws(), 0).find("tolerance"), std::string::npos);
  machine.mass(0, 1) = 0.25;
  EXPECT_NE(refusal(machine, stribeck_laws(), 1e-12).find("mass"), std::string::npos);
  const Adaptive adaptive(stribeck_machine(), stribeck_laws());
  EXPECT_THROW(adaptive.run(stribeck_start(), INFINITY), InputError);
  EXPECT_THROW(adaptive.run({0, Eigen::Vector3d{1, 2, 3}, Eigen::Vector2d{0, 0}}, 1), InputError);
  EXPECT_THROW(adaptive.run({0, Eigen::Vector2d{NAN, 0}, Eigen::Vector2d{0, 0}}, 1), InputError);
}

}  // namespace
}  // namespace breakaway::hybrid::adaptive_test
