#include "breakaway/hybrid/adaptive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "../refusal.hpp"
#include "breakaway/hybrid/event_driven.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/slide.hpp"

namespace {

namespace model = breakaway::model;
namespace motion = breakaway::motion;
namespace stability = breakaway::stability;
using breakaway::InputError;
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

// One case of tests/reference/friction_law_machine.csv.
struct Reference {
  std::vector<Event> events;
  double end_s = 0;
  std::map<int, double> q, v;
};

Reference read_reference(const std::string& name) {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/friction_law_machine.csv");
  Reference reference;
  for (std::string line; std::getline(file, line);) {
    std::istringstream fields(line);
    std::string what[4];
    for (std::string& field : what) std::getline(fields, field, ',');
    if (what[0] != name) continue;
    const int index = std::stoi(what[2]);
    const double value = std::stod(what[3]);
    if (what[1] == "end") {
      reference.end_s = value;
    } else if (what[1] == "q" || what[1] == "v") {
      (what[1] == "q" ? reference.q : reference.v)[index] = value;
    } else {
      const EventKind kind = what[1] == "stick"  ? EventKind::stick
                             : what[1] == "slip" ? EventKind::slip
                                                 : EventKind::reversal;
      reference.events.push_back({value, kind, index});
    }
  }
  return reference;
}

double error_of(const Reference& reference, const Adaptive& adaptive, const State& start, double end_s) {
  std::vector<Event> log;
  const auto outcome = adaptive.run(start, end_s, &log);
  EXPECT_FALSE(reference.q.empty());
  EXPECT_EQ(log.size(), reference.events.size());
  double error = std::abs(outcome.end.time_s - reference.end_s);
  for (std::size_t i = 0; i < std::min(log.size(), reference.events.size()); ++i) {
    EXPECT_EQ(log[i].kind, reference.events[i].kind) << i;
    EXPECT_EQ(log[i].direction, reference.events[i].direction) << i;
    error = std::max(error, std::abs(log[i].time_s - reference.events[i].time_s));
  }
  for (const auto& [i, q] : reference.q) error = std::max(error, std::abs(outcome.end.q[i] - q));
  for (const auto& [i, v] : reference.v) error = std::max(error, std::abs(outcome.end.v[i] - v));
  std::printf("error %.1e in %zu events, %llu steps\n", error, log.size(),
              static_cast<unsigned long long>(outcome.steps));
  return error;
}

LinearMachine<> stribeck_machine() { return unequal_masses(); }

Adaptive::Laws stribeck_laws() {
  return {{model::FrictionBounds{0.25, 0.5}, model::shape::stribeck(0.25)},
          {model::FrictionBounds{0.375, 1}, model::shape::stribeck_gaussian(0.5)}};
}

State stribeck_start() { return {0, Eigen::Vector2d{2, -1.5}, Eigen::Vector2d{0.5, 1}}; }

// Measured: 5e-13. A limit that gives way 1e-12 late, at a rate of some N/s, and steps of 1e-12.
TEST(Adaptive, FollowsFallingFrictionThroughSticksAndSlips) {
  const Adaptive adaptive(stribeck_machine(), stribeck_laws());
  EXPECT_LT(error_of(read_reference("stribeck"), adaptive, stribeck_start(), 12), tolerance);
}

// What a user pays for accuracy: the error stays within a hundred times the tolerance, and looser ones take fewer
// steps.
TEST(Adaptive, ErrsByItsTolerance) {
  const Reference reference = read_reference("stribeck");
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

// The work of all friction and damping, by the trapezoidal rule over short steps, is the energy that is lost.
TEST(Adaptive, KeepsTheBalanceOfEnergy) {
  const auto machine = stribeck_machine();
  const auto laws = stribeck_laws();
  const Adaptive adaptive(machine, laws, {.longest_step_s = 1e-3});
  const auto power_W = [&](const State& state) {
    double power = state.v.dot(machine.damping * state.v);
    for (Eigen::Index i = 0; i < 2; ++i) {
      power += laws[static_cast<std::size_t>(i)].level_N(state.time_s, state.q[i], std::abs(state.v[i])) *
               std::abs(state.v[i]);
    }
    return power;
  };
  double lost_J = 0, energy_J = stability::energy_J(machine, stribeck_start());
  State before = stribeck_start();
  const double start_J = energy_J;
  const auto outcome = adaptive.run(before, 12, nullptr, [&](const State& state) {
    lost_J += (state.time_s - before.time_s) * (power_W(before) + power_W(state)) / 2;
    before = state;
    energy_J = stability::energy_J(machine, state);
    // The trapezoidal rule errs by h^2 / 12 times the change of the power's slope, which friction makes jump.
    EXPECT_NEAR(energy_J + lost_J, start_J, 1e-5);
  });
  EXPECT_GT(lost_J, 0.5 * start_J);
  EXPECT_GT(outcome.events, 5U);
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

model::ShapePtr random_shape(std::mt19937& random) {
  const auto number = [&](double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random);
  };
  std::vector<model::ShapePtr> parts;
  switch (std::uniform_int_distribution<int>(0, 8)(random)) {
    case 0:
      return model::shape::static_kinetic(number(0.5, 1), number(0, 0.5));
    case 1:
      return model::shape::stribeck(number(0.05, 1));
    case 2:
      return model::shape::stribeck_gaussian(number(0.05, 1));
    case 3:
      return model::shape::sine_in_time(number(0.5, 8), number(0, 6));
    case 4:
      return model::shape::sine_in_position(number(0.1, 2), number(0, 6));
    case 5:
      return model::shape::position_table({number(-2, 0), number(0.1, 2)}, {number(0, 1), number(0, 1), number(0, 1)});
    case 6:
      return model::shape::random_dwell(
          {.seed = random(), .shortest_dwell_s = 0.1, .longest_dwell_s = 1, .bound_share = 0.2});
    case 7:
      return model::shape::constant(number(0, 1));
    default:
      parts.push_back(model::shape::stribeck(number(0.05, 1)));
      parts.push_back(model::shape::position_table({0}, {number(0, 1), number(0, 1)}));
      return model::shape::product(std::move(parts));
  }
}

// Any law, dependent directions and more of them than coordinates included: V of (5) never rises under damping >= 0
// by more than the steps err.
TEST(Adaptive, EnergyNeverRisesInRandomMachines) {
  std::mt19937 random(20261121);
  std::uniform_real_distribution<double> entry(-1, 1);
  const auto matrix = [&](Eigen::Index rows, Eigen::Index columns) {
    return MatrixXd(MatrixXd::NullaryExpr(rows, columns, [&] { return entry(random); }));
  };
  std::uint64_t events = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto n = std::uniform_int_distribution<Eigen::Index>(1, 4)(random);
    const auto m = std::uniform_int_distribution<Eigen::Index>(0, 5)(random);
    const auto square = [&] {
      const MatrixXd root = matrix(n, n);
      return MatrixXd(root * root.transpose() + 0.1 * MatrixXd::Identity(n, n));
    };
    LinearMachine<> machine;
    machine.mass = square();
    machine.damping = 0.1 * square();
    machine.stiffness = square();
    machine.directions = matrix(n, m);
    if (m > 1 && trial % 3 == 0) machine.directions.col(1) = -machine.directions.col(0);
    machine.friction_N = VectorXd::Zero(m);
    Adaptive::Laws laws;
    for (Eigen::Index i = 0; i < m; ++i) {
      const double lower_N = 0.05 + 0.2 * std::abs(entry(random));
      laws.push_back({model::FrictionBounds{lower_N, lower_N + 0.3}, random_shape(random)});
    }
    const State start{0, matrix(n, 1), trial % 4 == 0 ? MatrixXd(VectorXd::Zero(n)) : matrix(n, 1)};
    double energy_J = stability::energy_J(machine, start);
    const double rounding_J = 1e-11 * energy_J;
    const auto outcome = Adaptive(machine, laws).run(start, 15, nullptr, [&](const State& state) {
      const double now_J = stability::energy_J(machine, state);
      EXPECT_LE(now_J, energy_J + rounding_J) << "trial " << trial << " at " << state.time_s;
      energy_J = now_J;
    });
    events += outcome.events;
  }
  EXPECT_GT(events, 1000U);
}

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
