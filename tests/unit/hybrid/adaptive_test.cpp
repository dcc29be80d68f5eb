#include "breakaway/hybrid/adaptive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "breakaway/friction/shapes.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/plant/slide.hpp"

namespace {

namespace friction = breakaway::friction;
namespace plant = breakaway::plant;
using breakaway::hybrid::Adaptive;
using breakaway::hybrid::Event;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::EventKind;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Verdict;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using State = MachineState<Eigen::Dynamic>;

LinearMachine<> two_masses() {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = Eigen::Matrix2d{{0.125, 0.375}, {0.375, 0.125}};
  machine.stiffness = Eigen::Matrix2d{{2, -1}, {-1, 2}};
  machine.directions = Eigen::Matrix2d::Identity();
  machine.friction_N = Eigen::Vector2d{1, 1};
  return machine;
}

LinearMachine<> unequal_masses() {
  LinearMachine<> machine = two_masses();
  machine.mass = Eigen::Matrix2d{{0.5, 0}, {0, 2}};
  machine.damping = Eigen::Matrix2d{{0.25, -0.125}, {-0.0625, 0.125}};
  machine.stiffness = Eigen::Matrix2d{{3, -1}, {-1, 1.5}};
  machine.friction_N = Eigen::Vector2d{0.375, 0.75};
  return machine;
}

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

// Steps of 1e-12 relative to states of about one, and limits that give way at 1 + 1e-12 of theirs; some ten events.
constexpr double tolerance = 2e-11;

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
  friction::ShapePtr (*make)();
};

friction::ShapePtr of_the_example() {
  std::vector<friction::ShapePtr> parts;
  parts.push_back(friction::stribeck(2));
  parts.push_back(friction::sine_in_time(4));
  return friction::mean({0.5, 0.5}, std::move(parts));
}

class OneCoordinate : public ::testing::TestWithParam<NamedShape> {};

// Both integrate to rounding by themselves, one on closed forms and its own flights, the other as any machine.
TEST_P(OneCoordinate, MovesAsTheSlideDoes) {
  const friction::FrictionLaw law{friction::FrictionBounds{0.5, 1.5}, GetParam().make()};
  LinearMachine<> machine;
  machine.mass = machine.directions = MatrixXd::Identity(1, 1);
  machine.damping = MatrixXd::Constant(1, 1, 0.05);
  machine.stiffness = MatrixXd::Constant(1, 1, 4);
  machine.friction_N = VectorXd::Zero(1);
  plant::Slide slide(1, law, {0, 3, -1});
  plant::AppliedForce force;
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
    ::testing::Values(
        NamedShape{"constant", [] { return friction::constant(0.3); }},
        NamedShape{"static_kinetic", [] { return friction::static_kinetic(1, 0.1); }},
        NamedShape{"stribeck", [] { return friction::stribeck(0.2); }},
        NamedShape{"stribeck_gaussian", [] { return friction::stribeck_gaussian(0.2); }},
        NamedShape{"sine_in_time", [] { return friction::sine_in_time(4); }},
        NamedShape{"sine_in_position", [] { return friction::sine_in_position(0.7, 0.2); }},
        NamedShape{"position_table",
                   [] {
                     return friction::position_table({-0.5, 0.25, 1}, {0.2, 1, 0, 0.7});
                   }},
        NamedShape{"random_dwell",
                   [] { return friction::random_dwell({.seed = 7, .shortest_dwell_s = 0.05, .longest_dwell_s = 1}); }},
        NamedShape{"example", of_the_example}),
    [](const auto& shape) { return shape.param.name; });

}  // namespace
