#include "breakaway/machine/run_machine.hpp"

#include <gtest/gtest.h>

#include "breakaway/scenario/input_error.hpp"

namespace {

using namespace breakaway;

scenario::MachineScenario two_masses() {
  return scenario::read_machine_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_mass_example.toml");
}

TEST(RunMachine, FollowsTheExampleThroughItsModes) {
  const auto result = machine::run_machine(two_masses());
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
  const auto exact = machine::run_machine(s);
  s.integrator = scenario::Integrator::time_stepping;
  s.step_s = 1e-4;
  const auto stepped = machine::run_machine(s);
  EXPECT_TRUE(stepped.settled());
  EXPECT_LT((stepped.outcome.end.q - exact.outcome.end.q).norm(), 1e-4);
  EXPECT_NEAR(stepped.outcome.settling_time_s, exact.outcome.settling_time_s, 1e-3);
  EXPECT_EQ(stepped.modes.back(), exact.modes.back());
  EXPECT_TRUE(stepped.warning.empty());
  s.theta = 1;
  EXPECT_NE(machine::run_machine(s).warning.find("theta"), std::string::npos);
}

TEST(RunMachine, TellsWhatNeverComesToRest) {
  auto s = two_masses();
  s.start->q = Eigen::Vector2d{7, -7};
  const auto result = machine::run_machine(s);
  EXPECT_FALSE(result.settled());
  EXPECT_EQ(result.proved, hybrid::Verdict::lost);
  EXPECT_EQ(result.outcome.end.time_s, 60);
}

TEST(RunMachine, NeedsAStart) {
  auto s = two_masses();
  s.start.reset();
  EXPECT_THROW(machine::run_machine(s), scenario::InputError);
}

}  // namespace
