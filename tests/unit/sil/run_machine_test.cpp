#include "breakaway/sil/run_machine.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "breakaway/input/input_error.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/report/machine_report.hpp"
#include "two_masses.hpp"

namespace {

using namespace breakaway;

TEST(RunMachine, FollowsTheExampleThroughItsModes) {
  const auto result = sil::run_machine(two_masses());
  EXPECT_TRUE(result.settled());
  EXPECT_EQ(result.proved, hybrid::Verdict::captured);
  EXPECT_EQ(result.modes.front(), (std::vector{-1, 1}));  // from (2.5, -1) the springs pull both inward
  EXPECT_EQ(result.modes.back(), (std::vector{0, 0}));
  for (std::size_t i = 1; i < result.modes.size(); ++i) EXPECT_NE(result.modes[i], result.modes[i - 1]);
  EXPECT_TRUE(result.outcome.end.v.isZero(0));
  ASSERT_FALSE(result.events.empty());
  EXPECT_EQ(result.events.back().kind, hybrid::EventKind::stick);
  EXPECT_EQ(result.events.back().time_s, result.outcome.settling_time_s);
}

// The scheme is of the first order: at h = 1e-4 it is known to be 1.7e-5 off.
TEST(RunMachine, SteppingComesNearTheExactEnd) {
  auto s = two_masses();
  const auto exact = sil::run_machine(s);
  s.integrator = scenario::Integrator::time_stepping;
  s.step_s = 1e-4;
  const auto stepped = sil::run_machine(s);
  EXPECT_TRUE(stepped.settled());
  EXPECT_LT((stepped.outcome.end.q - exact.outcome.end.q).norm(), 1e-4);
  EXPECT_NEAR(stepped.outcome.settling_time_s, exact.outcome.settling_time_s, 1e-3);
  EXPECT_EQ(stepped.modes.back(), exact.modes.back());
  EXPECT_TRUE(stepped.warning.empty());
  s.theta = 1;
  EXPECT_NE(sil::run_machine(s).warning.find("theta"), std::string::npos);
}

TEST(RunMachine, TellsWhatNeverComesToRest) {
  auto s = two_masses();
  s.start->q = Eigen::Vector2d{7, -7};
  const auto result = sil::run_machine(s);
  EXPECT_FALSE(result.settled());
  EXPECT_EQ(result.proved, hybrid::Verdict::lost);
  EXPECT_EQ(result.outcome.end.time_s, 60);
}

TEST(RunMachine, NeedsAStart) {
  auto s = two_masses();
  s.start.reset();
  EXPECT_THROW(sil::run_machine(s), InputError);
}

// One mass on a spring under 0.5 N: each half swing is a half period about a centre that friction shifts.
scenario::MachineScenario one_mass(scenario::Integrator integrator) {
  scenario::MachineScenario s;
  s.machine.mass = s.machine.directions = Eigen::MatrixXd::Identity(1, 1);
  s.machine.stiffness = Eigen::MatrixXd::Constant(1, 1, 4);
  s.machine.damping = Eigen::MatrixXd::Zero(1, 1);
  s.machine.friction_N = Eigen::VectorXd::Constant(1, 0.5);
  s.start = {0, Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Zero(1)};
  s.impulses = {{2, Eigen::VectorXd::Constant(1, 0.75)}};
  s.integrator = integrator;
  s.step_s = 1e-4;
  return s;
}

// Held at 0.1 m until 2 s, then thrown off at 0.75 m/s: about the centre -f/k = -0.125 m it swings out to
// -f/k + hypot(0.1 + f/k, v/omega), and there static friction holds it or not.
TEST(RunMachine, AppliesImpulsesWithEveryIntegrator) {
  const double centre = -0.5 / 4, reach = std::hypot(0.1 - centre, 0.75 / 2), out = centre + reach;
  const double back_to = 2 * 0.125 - out;  // half a period about +f/k
  ASSERT_GT(4 * out, 0.5);
  ASSERT_LT(4 * std::abs(back_to), 0.5);
  const double turn_s = 2 + std::atan2(0.75 / 2, 0.1 - centre) / 2;
  for (const auto integrator : {scenario::Integrator::event_driven, scenario::Integrator::adaptive}) {
    const auto result = sil::run_machine(one_mass(integrator));
    EXPECT_TRUE(result.settled());
    EXPECT_NEAR(result.outcome.end.q[0], back_to, 1e-12);
    EXPECT_NEAR(result.outcome.settling_time_s, turn_s + std::numbers::pi / 2, 1e-12);
    EXPECT_EQ(result.modes, (std::vector<std::vector<int>>{{0}, {1}, {-1}, {0}}));
  }
  const auto stepped = sil::run_machine(one_mass(scenario::Integrator::time_stepping));
  EXPECT_NEAR(stepped.outcome.end.q[0], back_to, 1e-4);  // of the first order in 1e-4 s
}

TEST(RunMachine, FollowsLawsThroughTheScenario) {
  auto s = scenario::read_machine_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_mass_stribeck.toml");
  const auto result = sil::run_machine(s);
  EXPECT_TRUE(result.settled());
  EXPECT_GT(result.outcome.settling_time_s, s.impulses.back().time_s);
  EXPECT_GT(result.events.size(), 8U);
  EXPECT_EQ(result.modes.back(), (std::vector{0, 0}));
  // A trace limits the steps and no more than that.
  const auto traced = sil::run_machine(s, {.trace = true});
  EXPECT_GT(traced.trace.size(), 200U);
  EXPECT_LT((traced.outcome.end.q - result.outcome.end.q).norm(), 1e-10);
  ASSERT_EQ(traced.events.size(), result.events.size());
  EXPECT_NEAR(traced.events.back().time_s, result.events.back().time_s, 1e-10);
  EXPECT_EQ(traced.modes, result.modes);
}

// For every integrator a trace runs from the start to the end, in the order of time, and is dense enough for a picture.
TEST(RunMachine, TracesWhatHappened) {
  for (const auto integrator :
       {scenario::Integrator::event_driven, scenario::Integrator::time_stepping, scenario::Integrator::adaptive}) {
    auto s = two_masses();
    s.integrator = integrator;
    const auto result = sil::run_machine(s, {.trace = true});
    ASSERT_GT(result.trace.size(), 100U);
    EXPECT_EQ(result.trace.front().q, s.start->q);
    EXPECT_EQ(result.trace.back().q, result.outcome.end.q);
    for (std::size_t i = 1; i < result.trace.size(); ++i) {
      EXPECT_GE(result.trace[i].time_s, result.trace[i - 1].time_s);
      EXPECT_LT(result.trace[i].time_s - result.trace[i - 1].time_s, s.duration_s / 500);
    }
    EXPECT_EQ(report::to_csv(s, result).substr(0, 38), "time_s,q1,q2,v1,v2,slides1,slides2\n0,2");
  }
}

// f = K c shifts everything by c, certificates included.
TEST(RunMachine, CertifiesAboutTheCentreThatAForceShifts) {
  auto s = two_masses();
  const Eigen::VectorXd shift = Eigen::Vector2d{100, -50};
  const auto unshifted = sil::run_machine(s);
  s.machine.force_N = s.machine.stiffness * shift;
  s.start->q += shift;
  const auto result = sil::run_machine(s);
  EXPECT_EQ(result.proved, hybrid::Verdict::captured);
  EXPECT_LT((result.outcome.end.q - shift - unshifted.outcome.end.q).norm(), 1e-11);
}

TEST(RunMachine, CertifiesByTheBoundsOfTheLaws) {
  auto s = two_masses();
  const model::FrictionLaw law{model::FrictionBounds{1, 1.25}, model::shape::stribeck(0.5)};
  s.laws = {law, law};
  s.integrator = scenario::Integrator::adaptive;
  EXPECT_EQ(sil::run_machine(s).proved, hybrid::Verdict::captured);
  s.start->q = Eigen::Vector2d{7, -7};  // lost under 1 N, but not under 100 N
  EXPECT_EQ(sil::run_machine(s).proved, hybrid::Verdict::lost);
  const model::FrictionLaw wide{model::FrictionBounds{1, 100}, model::shape::stribeck(0.5)};
  s.laws = {wide, wide};
  EXPECT_EQ(sil::run_machine(s).proved, hybrid::Verdict::undecided);
}

}  // namespace
