#include "breakaway/hybrid/event_driven.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "reference_motion.hpp"

namespace event_driven_test {
namespace {

using breakaway::InputError;
using breakaway::hybrid::Event;
using breakaway::hybrid::EventDriven;
using breakaway::hybrid::largest_error;
using breakaway::hybrid::LinearMachine;
using breakaway::hybrid::MachineState;
using breakaway::hybrid::Outcome;
using breakaway::hybrid::read_reference_motion;
using breakaway::hybrid::ReferenceMotion;
using breakaway::hybrid::Verdict;
using breakaway::stability::unsized;
using State = MachineState<Eigen::Dynamic>;

// The largest error against that case of tests/reference/linear_machine.csv.
template <int N, int M>
double error_of(const std::string& name, const LinearMachine<N, M>& machine, const MachineState<N>& start,
                double end_time_s) {
  SCOPED_TRACE(name);
  const ReferenceMotion reference = read_reference_motion("linear_machine.csv", name);
  std::vector<Event> log;
  const Outcome<N> outcome = EventDriven<N, M>(machine).run(start, end_time_s, &log);
  const double error = largest_error(reference, log, outcome.end);
  EXPECT_EQ(outcome.verdict == Verdict::at_rest, reference.end_s < end_time_s);
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

// Sizes that are known when the machine is read: a pair that the compiler knows costs it as much as all else here.
TEST(EventDriven, FollowsThreeCoordinates) {
  LinearMachine<3, 3> machine;
  machine.mass = Eigen::Vector3d{1, 0.75, 1.5}.asDiagonal();
  machine.damping << 0.25, -0.125, 0, -0.125, 0.1875, -0.0625, 0, -0.0625, 0.125;
  machine.stiffness << 3, -1, 0, -1, 2, -1, 0, -1, 1.25;
  machine.directions.setIdentity();
  machine.friction_N << 0.5, 0.25, 0.375;
  const State start{0, Eigen::Vector3d{3, -1, 2}, Eigen::Vector3d{0, 0.5, -1}};
  EXPECT_LT(error_of("chain_of_three", unsized(machine), start, 60), tolerance);
}

// Of sizes that the library does not compile, and by what it compiles for all.
TEST(EventDriven, FollowsFewerFrictionsThanCoordinates) {
  LinearMachine<3, 1> machine;
  machine.mass << 1, 0.25, 0, 0.25, 1, 0, 0, 0, 2;
  machine.damping << 0.125, 0, 0, 0, 0.25, -0.125, 0, -0.125, 0.25;
  machine.stiffness << 2, -1, 0, -1, 2, -1, 0, -1, 2;
  machine.directions << 1, -1, 0;
  machine.friction_N << 0.75;
  EXPECT_LT(error_of("one_joint_for_three", machine, MachineState<3>{0, {2, -1, 1}, {0, 1, 0}}, 12), tolerance);
  const State start{0, Eigen::Vector3d{2, -1, 1}, Eigen::Vector3d{0, 1, 0}};
  EXPECT_LT(error_of("one_joint_for_three", unsized(machine), start, 12), tolerance);
}

TEST(EventDriven, FollowsMoreFrictionsThanCoordinates) {
  LinearMachine<2, 3> machine;
  machine.mass << 1, 0, 0, 0.5;
  machine.damping << 0.125, 0, 0, 0.0625;
  machine.stiffness << 2, -1, -1, 3;
  machine.directions << 1, 0, 1, 0, 1, -1;
  machine.friction_N << 0.25, 0.375, 0.5;
  const State start{0, Eigen::Vector2d{3, -2}, Eigen::Vector2d{1, 0}};
  EXPECT_LT(error_of("three_joints_for_two", unsized(machine), start, 60), tolerance);
}

TEST(EventDriven, FollowsJointsBetweenCoordinates) {
  LinearMachine<3, 2> machine;
  machine.mass = Eigen::Vector3d{2, 1, 0.5}.asDiagonal();
  machine.damping = Eigen::Vector3d{0.125, 0.125, 0.125}.asDiagonal();
  machine.stiffness << 2, -1, 0, -1, 3, -1.5, 0, -1.5, 2;
  machine.directions << 1, 0, -1, 1, 0, -1;
  machine.friction_N << 0.5, 0.25;
  const State start{0, Eigen::Vector3d{1, -2, 1}, Eigen::Vector3d{0, 0, 2}};
  EXPECT_LT(error_of("relative_joints", unsized(machine), start, 15), tolerance);
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

// Coupled one way, it grows by 41 decades a second, and its state is carried in 31 digits, which end before the
// exponents of double do. The numbers are those of machine 12624 of the campaign.
TEST(EventDriven, AMotionBeyondTheLargestNumberIsRefusedAndNeverNoNumber) {
  LinearMachine<> machine;
  for (Eigen::MatrixXd* matrix : {&machine.mass, &machine.damping, &machine.stiffness}) matrix->resize(5, 5);
  machine.mass << 1.6295116370829221, -1.0916318641561884, 0.2281207893612306, 0.9398279626347127, 0.001845230325399766,
      -1.0916318641561884, 2.345652001018705, -0.4329933921141065, -0.8462817838091372, 0.8633130218058526,
      0.2281207893612306, -0.4329933921141065, 0.6845198359618487, 0.6102164462428217, -0.1715580664616992,
      0.9398279626347127, -0.8462817838091372, 0.6102164462428217, 1.7644753977097751, 0.04567286280820604,
      0.001845230325399766, 0.8633130218058526, -0.1715580664616992, 0.04567286280820604, 1.1121128184450595;
  machine.damping << 0.8180896555421461, 60530.442759937854, 0.09297666474735157, 0.20213307288345275,
      0.09459677442841866, -0.05174025822386759, 0.24685707147364558, 0.473058346324083, -0.1691373584016761,
      -0.08337420661311776, 0.09297666474735157, 0.473058346324083, 1.0935320491214209, -0.2092246203677548,
      -0.2146738920829914, 0.20213307288345275, -0.1691373584016761, -0.2092246203677548, 0.25463826726238875,
      -0.008960381626664172, 0.09459677442841866, -0.08337420661311776, -0.2146738920829914, -0.008960381626664172,
      0.5133343483694365;
  machine.stiffness << 7.8978512164067585, -37637.46982806079, 1.4509610834553486, 4.849970840364285,
      -1.3846820723231146, -0.669365219090999, 5.987182686649193, -2.1865110119327187, -5.6939246598849165,
      -4.75595363696575, 1.4509610834553486, -2.1865110119327187, 8.375863374885533, 3.5900599781644003,
      -1.7200329092330489, 4.849970840364285, -5.6939246598849165, 3.5900599781644003, 10.276621102199655,
      44239.39990616474, -1.3846820723231146, -4.75595363696575, -1.7200329092330489, 4.833023425164805,
      7.7484518401291655;
  machine.directions = Eigen::MatrixXd(5, 1);
  machine.directions << 0.9577132045989631, 0.9961156415120456, -0.16155470487366563, 0.10231556410582576,
      -0.7279274169164287;
  machine.friction_N = Eigen::VectorXd::Constant(1, 0.745192999063985);
  MachineState<Eigen::Dynamic> start{0, Eigen::VectorXd(5), Eigen::VectorXd(5)};
  start.q << -1.7761806261043165, -0.4756107522481374, -1.6739551380239828, -2.526144955364493, -0.7901973384848566;
  start.v << 0.2203223715532434, -0.9662161740093498, -0.06385610152499943, 0.5475613300466715, -0.1636434947797154;
  EXPECT_TRUE(EventDriven<>(machine).run(start, 7).end.q.allFinite());
  EXPECT_THROW(EventDriven<>(machine).run(start, 7.33), InputError);
}

}  // namespace
}  // namespace event_driven_test
