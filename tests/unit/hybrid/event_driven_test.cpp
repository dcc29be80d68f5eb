#include "breakaway/hybrid/event_driven.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "breakaway/input/input_error.hpp"

namespace {

using breakaway::InputError;
using breakaway::hybrid::Event;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::EventKind;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Outcome;
using breakaway::hybrid::Verdict;

// One case of tests/reference/linear_machine.csv.
struct Reference {
  std::vector<Event> events;
  double end_s = 0;
  std::map<int, double> q, v;
};

Reference read_reference(const std::string& name) {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/linear_machine.csv");
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
    } else if (what[1] == "q") {
      reference.q[index] = value;
    } else if (what[1] == "v") {
      reference.v[index] = value;
    } else {
      const EventKind kind = what[1] == "stick"  ? EventKind::stick
                             : what[1] == "slip" ? EventKind::slip
                                                 : EventKind::reversal;
      reference.events.push_back({value, kind, index});
    }
  }
  return reference;
}

// The largest error in event times and the state at the end.
template <int N, int M>
double error_of(const std::string& name, const LinearMachine<N, M>& machine, const MachineState<N>& start,
                double end_time_s) {
  const Reference reference = read_reference(name);
  std::vector<Event> log;
  const Outcome<N> outcome = EventDriven<N, M>(machine).run(start, end_time_s, &log);
  EXPECT_FALSE(reference.q.empty()) << name;
  EXPECT_EQ(log.size(), reference.events.size()) << name;
  double error = std::abs(outcome.end.time_s - reference.end_s);
  for (std::size_t i = 0; i < std::min(log.size(), reference.events.size()); ++i) {
    EXPECT_EQ(log[i].kind, reference.events[i].kind) << name << " event " << i;
    EXPECT_EQ(log[i].direction, reference.events[i].direction) << name << " event " << i;
    error = std::max(error, std::abs(log[i].time_s - reference.events[i].time_s));
  }
  for (const auto& [i, q] : reference.q) error = std::max(error, std::abs(outcome.end.q[i] - q));
  for (const auto& [i, v] : reference.v) error = std::max(error, std::abs(outcome.end.v[i] - v));
  EXPECT_EQ(outcome.verdict == Verdict::at_rest, reference.end_s < end_time_s) << name;
  ::testing::Test::RecordProperty(name, std::to_string(error));
  std::printf("%-22s error %.1e in %zu events\n", name.c_str(), error, log.size());
  return error;
}

LinearMachine<2, 2> two_mass_example() {
  LinearMachine<2, 2> machine;
  machine.mass.setIdentity();
  machine.damping << 0.125, 0.375, 0.375, 0.125;
  machine.stiffness << 2, -1, -1, 2;
  machine.directions.setIdentity();
  machine.friction_N << 1, 1;
  return machine;
}

// The state is about one, so these are relative errors too. Measured: at most 5e-15.
constexpr double tolerance = 1e-13;

TEST(EventDriven, FollowsTheTwoMassExampleToRest) {
  EXPECT_LT(error_of("two_mass", two_mass_example(), MachineState<2>{0, {2.5, -1}, {0, 0}}, 60), tolerance);
}

TEST(EventDriven, FollowsUnequalMassesFrictionsAndAnUnsymmetricDamping) {
  LinearMachine<2, 2> machine;
  machine.mass << 0.5, 0, 0, 2;
  machine.damping << 0.25, -0.125, -0.0625, 0.125;
  machine.stiffness << 3, -1, -1, 1.5;
  machine.directions.setIdentity();
  machine.friction_N << 0.375, 0.75;
  EXPECT_LT(error_of("unequal", machine, MachineState<2>{0, {2, -1.5}, {0.5, 1}}, 60), tolerance);
}

LinearMachine<3, 3> chain_of_three() {
  LinearMachine<3, 3> machine;
  machine.mass = Eigen::Vector3d{1, 0.75, 1.5}.asDiagonal();
  machine.damping << 0.25, -0.125, 0, -0.125, 0.1875, -0.0625, 0, -0.0625, 0.125;
  machine.stiffness << 3, -1, 0, -1, 2, -1, 0, -1, 1.25;
  machine.directions.setIdentity();
  machine.friction_N << 0.5, 0.25, 0.375;
  return machine;
}

TEST(EventDriven, FollowsThreeCoordinates) {
  EXPECT_LT(error_of("chain_of_three", chain_of_three(), MachineState<3>{0, {3, -1, 2}, {0, 0.5, -1}}, 60), tolerance);
}

TEST(EventDriven, SizesMayBeDynamic) {
  const auto fixed = chain_of_three();
  const LinearMachine<> machine{fixed.mass, fixed.damping, fixed.stiffness, fixed.directions, fixed.friction_N, {}};
  MachineState<Eigen::Dynamic> start;
  start.q = Eigen::Vector3d{3, -1, 2};
  start.v = Eigen::Vector3d{0, 0.5, -1};
  EXPECT_LT(error_of("chain_of_three", machine, start, 60), tolerance);
}

TEST(EventDriven, FollowsFewerFrictionsThanCoordinates) {
  LinearMachine<3, 1> machine;
  machine.mass << 1, 0.25, 0, 0.25, 1, 0, 0, 0, 2;
  machine.damping << 0.125, 0, 0, 0, 0.25, -0.125, 0, -0.125, 0.25;
  machine.stiffness << 2, -1, 0, -1, 2, -1, 0, -1, 2;
  machine.directions << 1, -1, 0;
  machine.friction_N << 0.75;
  EXPECT_LT(error_of("one_joint_for_three", machine, MachineState<3>{0, {2, -1, 1}, {0, 1, 0}}, 12), tolerance);
}

TEST(EventDriven, FollowsMoreFrictionsThanCoordinates) {
  LinearMachine<2, 3> machine;
  machine.mass << 1, 0, 0, 0.5;
  machine.damping << 0.125, 0, 0, 0.0625;
  machine.stiffness << 2, -1, -1, 3;
  machine.directions << 1, 0, 1, 0, 1, -1;
  machine.friction_N << 0.25, 0.375, 0.5;
  EXPECT_LT(error_of("three_joints_for_two", machine, MachineState<2>{0, {3, -2}, {1, 0}}, 60), tolerance);
}

TEST(EventDriven, FollowsJointsBetweenCoordinates) {
  LinearMachine<3, 2> machine;
  machine.mass = Eigen::Vector3d{2, 1, 0.5}.asDiagonal();
  machine.damping = Eigen::Vector3d{0.125, 0.125, 0.125}.asDiagonal();
  machine.stiffness << 2, -1, 0, -1, 3, -1.5, 0, -1.5, 2;
  machine.directions << 1, 0, -1, 1, 0, -1;
  machine.friction_N << 0.5, 0.25;
  EXPECT_LT(error_of("relative_joints", machine, MachineState<3>{0, {1, -2, 1}, {0, 0, 2}}, 15), tolerance);
}

TEST(EventDriven, FollowsCriticalDamping) {
  LinearMachine<2, 2> machine;
  machine.mass.setIdentity();
  machine.damping << 2, 0, 0, 4;
  machine.stiffness << 1, 0, 0, 4;
  machine.directions << 1, 0.5, 0.5, 1;
  machine.friction_N << 0.25, 0.125;
  EXPECT_LT(error_of("critically_damped", machine, MachineState<2>{0, {2, -3}, {0, 0}}, 20), tolerance);
}

TEST(EventDriven, StaysWhereStaticFrictionHolds) {
  const auto outcome = EventDriven<2, 2>(two_mass_example()).run({3, {0.25, 0.25}, {0, 0}}, 1e300);
  EXPECT_EQ(outcome.verdict, Verdict::at_rest);
  EXPECT_EQ(outcome.settling_time_s, 3);
  EXPECT_EQ(outcome.events, 0U);
}

// It comes to rest in ever smaller slips, each stick at the limit of static friction: without end, but for rounding.
TEST(EventDriven, EndsASlipThatIsLostInRounding) {
  LinearMachine<3, 1> machine;
  machine.mass << 1.8412899265423803, 0.66296487350257483, 0.36917077656401809, 0.66296487350257483,
      0.97575605760044937, -0.076167786873186122, 0.36917077656401809, -0.076167786873186122, 0.67374139431349744;
  machine.damping << 0.41668588862151285, 0.13335631378932172, -0.3157394395152085, 0.13335631378932172,
      1.4112847613823758, 0.10637869139171144, -0.3157394395152085, 0.10637869139171144, 0.20361522054965264;
  machine.stiffness << 5.6542942109856416, -2.0219919016572492, 2.4072143434813804, -2.0219919016572492,
      1.0745721214237025, -1.0496592188587854, 2.4072143434813804, -1.0496592188587854, 3.1848395995985319;
  machine.directions << 0.70218775702224212, -0.13490984870298306, 0.96238238108575047;
  machine.friction_N << 0.74317635189179254;
  const MachineState<3> start{
      0, {3.6010703801429602, -2.8003992995060702, -7.5513588366606319}, {-10.74149938215376, -6.43362322, 1.10440567}};
  const auto outcome = EventDriven<3, 1>(machine).run(start, 2000);
  EXPECT_LT(outcome.end.v.norm(), 1e-11);  // at rest, or as good as: compilers round differently
  // What the springs need lies along W, at the limit.
  const Eigen::Vector3d springs = machine.stiffness * outcome.end.q;
  const double share = springs.dot(machine.directions) / machine.directions.squaredNorm();
  EXPECT_LT((springs - share * machine.directions).norm(), 1e-11);
  EXPECT_NEAR(std::abs(share), machine.friction_N[0], 1e-11);
}

TEST(EventDriven, EndsOnTheCallersDecision) {
  const EventDriven<2, 2> integrator(two_mass_example(), [](const MachineState<2>& state) {
    return state.q.norm() < 1 ? Verdict::captured : Verdict::undecided;
  });
  const auto outcome = integrator.run({0, {2.5, -1}, {0, 0}}, 60);
  EXPECT_EQ(outcome.verdict, Verdict::captured);
  EXPECT_LT(outcome.settling_time_s, 7.2);
}

// A machine whose size is read at run time is handed to code of that size, with its observer and its decision.
TEST(EventDriven, GivesTheSameBitsAtASizeThatIsReadAtRunTime) {
  std::vector<Event> log, log_of_any;
  std::vector<double> seen, seen_of_any;
  const auto end = EventDriven<2, 2>(two_mass_example()).run({0, {2.5, -1}, {0, 0}}, 60, &log, [&](const auto& s) {
    seen.push_back(s.q[0]);
  });
  const MachineState<Eigen::Dynamic> start{0, Eigen::Vector2d{2.5, -1}, Eigen::Vector2d{0, 0}};
  const EventDriven<> any(breakaway::stability::unsized(two_mass_example()));
  const auto end_of_any = any.run(start, 60, &log_of_any, [&](const auto& s) { seen_of_any.push_back(s.q[0]); });
  EXPECT_EQ(end_of_any.verdict, end.verdict);
  EXPECT_EQ(end_of_any.settling_time_s, end.settling_time_s);
  EXPECT_EQ(end_of_any.end.q, end.end.q);
  EXPECT_EQ(end_of_any.steps, end.steps);
  EXPECT_EQ(end_of_any.events, end.events);
  EXPECT_EQ(seen_of_any, seen);
  ASSERT_EQ(log_of_any.size(), log.size());
  for (std::size_t i = 0; i < log.size(); ++i) EXPECT_EQ(log_of_any[i].time_s, log[i].time_s);

  const EventDriven<> decided(breakaway::stability::unsized(two_mass_example()),
                              [](const auto& s) { return s.q.norm() < 1 ? Verdict::lost : Verdict::undecided; });
  EXPECT_EQ(decided.run(start, 60).verdict, Verdict::lost);
  EXPECT_THROW(any.run({0, Eigen::Vector3d::Zero(), Eigen::Vector2d::Zero()}, 1), InputError);
}

TEST(EventDriven, RefusesByName) {
  auto machine = two_mass_example();
  machine.friction_N[1] = -1;
  EXPECT_THROW((EventDriven<2, 2>(machine)), InputError);
  const EventDriven<2, 2> good(two_mass_example());
  EXPECT_THROW(good.run({0, {NAN, 0}, {0, 0}}, 1), InputError);
}

// W_T of seventeen columns.
TEST(EventDriven, RefusesMoreDirectionsThanItCanTabulate) {
  LinearMachine<> machine;
  machine.mass = machine.damping = machine.stiffness = Eigen::MatrixXd::Identity(17, 17);
  machine.directions = Eigen::MatrixXd::Identity(17, 17);
  machine.friction_N = Eigen::VectorXd::Ones(17);
  EXPECT_THROW((EventDriven<>(machine)), InputError);
}

}  // namespace
