#include "breakaway/law/kick_coordinator.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace breakaway::law {
namespace {

using Parameters = CoordinatorParameters<double, 4>;
using Coordinator = KickCoordinator<double, 4>;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Two axes of 2 kg with friction 2.5 to 4.5 N; each asks a quarter of its force of the other.
Parameters two_axes() {
  Parameters p;
  p.period_s = 1e-3;
  p.count = 2;
  p.settling_periods = 2;
  p.still_periods = 3;
  p.release_periods = 5;
  p.most_kicks = 10;
  for (std::size_t i = 0; i < 2; ++i)
    p.axes[i] = {.position_gain_N_per_m = 400,
                 .velocity_gain_Ns_per_m = 40,
                 .mass_kg = 2,
                 .lower_N = 2.5,
                 .upper_N = 4.5,
                 .sure_N = 4.51,
                 .brake_N = 0.5,
                 .kick_N = 40,
                 .max_force_N = 50,
                 .gate_m = 0.02,
                 .tolerance_m = 1e-5,
                 .resolution_m = 1e-6};
  p.hold_off[0][1] = p.hold_off[1][0] = 0.25;
  return p;
}

// Feeds readings and keeps the forces.
struct Bench {
  explicit Bench(const Parameters& parameters) : coordinator{parameters} {}

  void step(double first_m, double second_m) {
    outputs[0] = coordinator.update(0, {first_m, 0, true});
    outputs[1] = coordinator.update(1, {second_m, 0, true});
  }
  void steps(int count, double first_m, double second_m) {
    for (int n = 0; n < count; ++n) step(first_m, second_m);
  }
  // To the first period of the next kick.
  void to_kick(double first_m, double second_m) {
    bool kicked = false;
    for (int n = 0; n < 300 && !kicked; ++n) {
      step(first_m, second_m);
      kicked = outputs[0].kicked || outputs[1].kicked;
    }
  }
  double force_N(std::size_t axis) const { return outputs[axis].force_N; }

  Coordinator coordinator;
  std::array<ControlOutput<double>, 2> outputs{};
};

TEST(KickCoordinator, ApproachesEveryAxisWithItsGains) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.step(-0.05, 0.03);
  EXPECT_DOUBLE_EQ(bench.force_N(0), 20);
  EXPECT_DOUBLE_EQ(bench.force_N(1), -12);
  bench.step(-0.049, 0.03);
  EXPECT_NEAR(bench.force_N(0), 400 * 0.049 - 40 * 1.0, 1e-12);
  EXPECT_EQ(bench.outputs[0].mode, Mode::approach);
}

TEST(KickCoordinator, LetsGoOnceEveryAxisIsStillAndWithinItsGate) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(20, 0.03, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach) << "the first is outside its gate";
  bench.step(0.01, 0.001);
  bench.steps(2, 0.01, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
  bench.step(0.01, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
  for (int n = 0; n < p.release_periods; ++n) {
    bench.step(0.01, 0.001);
    EXPECT_EQ(bench.force_N(0), 0);
    EXPECT_EQ(bench.force_N(1), 0);
  }
  bench.step(0.01, 0.001);
  EXPECT_NE(bench.force_N(0), 0);
}

TEST(KickCoordinator, AKickGoesAsFarAsItAimsUnderTheLeastFrictionAndTheOtherAxisIsHeld) {
  const Parameters p = two_axes();
  Bench bench{p};
  const double at_m = -3e-4;
  bench.to_kick(at_m, 5e-6);
  const double force_N = bench.force_N(0);
  ASSERT_TRUE(bench.outputs[0].kicked);
  EXPECT_EQ(bench.outputs[0].mode, Mode::kick);
  EXPECT_GT(force_N, 4.51);
  EXPECT_LE(force_N, 40);
  EXPECT_DOUBLE_EQ(bench.force_N(1), 0.25 * (force_N - 3.5));
  int periods = 1;
  for (bench.step(at_m, 5e-6); bench.outputs[0].mode == Mode::kick; bench.step(at_m, 5e-6)) {
    EXPECT_FALSE(bench.outputs[0].kicked);
    ++periods;
  }
  const double t_s = periods * p.period_s;
  EXPECT_NEAR((force_N - 2.5) * (force_N + 0.5) * t_s * t_s / (2 * 2 * 3), 3e-4 - 0.5e-6, 1e-12);
  EXPECT_DOUBLE_EQ(bench.force_N(0), -0.5);
  EXPECT_DOUBLE_EQ(bench.force_N(1), -0.25 * (4.5 + 0.5) / 2);
}

TEST(KickCoordinator, KicksTheOtherWayWithEveryForceTurned) {
  const Parameters p = two_axes();
  Bench one{p}, other{p};
  one.to_kick(-3e-4, 5e-6);
  other.to_kick(3e-4, -5e-6);
  EXPECT_DOUBLE_EQ(one.force_N(0), -other.force_N(0));
  EXPECT_DOUBLE_EQ(one.force_N(1), -other.force_N(1));
}

TEST(KickCoordinator, GoesOnWithAnAxisUntilItIsThereAndThenTakesTheNext) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 2e-4);
  bench.to_kick(1e-4, 2e-4);
  EXPECT_EQ(bench.coordinator.kicked(), 0U);
  bench.to_kick(5e-6, 2e-4);
  EXPECT_EQ(bench.coordinator.kicked(), 1U);
  for (int n = 0; n < 200; ++n) bench.step(5e-6, 8e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  EXPECT_EQ(bench.coordinator.end(), CoordinatorEnd::on_target);
  EXPECT_EQ(bench.coordinator.kicks(), 3U);
  EXPECT_EQ(bench.force_N(0), 0);
  EXPECT_EQ(bench.outputs[1].mode, Mode::hold);
}

TEST(KickCoordinator, AnotherAxisThatMovesIsNamed) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 2e-4);
  bench.steps(200, 1e-4, 2.03e-4);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::contradicted);
  EXPECT_EQ(bench.coordinator.moved(), 1U);
  EXPECT_EQ(bench.force_N(0), 0);
  EXPECT_EQ(bench.outputs[0].mode, Mode::fault);
}

TEST(KickCoordinator, AKickThatGoesBeyondIsNamed) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 5e-6);
  bench.steps(200, -3e-6, 5e-6);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::contradicted);
  EXPECT_EQ(bench.coordinator.moved(), 0U);
}

TEST(KickCoordinator, EndsByNameWithinItsBudgetWhereNoKickMovesTheAxis) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(3000, 3e-4, 0);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::hunting);
  EXPECT_EQ(bench.coordinator.kicks(), p.most_kicks);
}

TEST(KickCoordinator, WhereEvenTheLeastSureForceGoesTooFarItHoldsAndSaysSo) {
  Parameters p = two_axes();
  p.axes[0].tolerance_m = 1e-7;
  p.axes[0].resolution_m = 1e-8;
  Bench bench{p};
  bench.steps(100, 3e-7, 0);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  EXPECT_EQ(bench.coordinator.end(), CoordinatorEnd::below_floor);
}

TEST(KickCoordinator, ADriveThatNoLongerGivesEnoughIsNamed) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.coordinator.limit_force(0, 4);
  bench.steps(100, 3e-4, 0);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::jammed);
}

TEST(KickCoordinator, ForcesStayWithinTheLimitOfEveryDrive) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.step(-10, 10);
  EXPECT_EQ(bench.force_N(0), 50);
  EXPECT_EQ(bench.force_N(1), -50);
}

TEST(KickCoordinator, AReadingThatIsNoNumberStopsAllForces) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 2e-4);
  bench.step(3e-4, nan);
  bench.step(3e-4, 2e-4);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::not_a_number);
  EXPECT_EQ(bench.force_N(0), 0);
}

TEST(KickCoordinator, AnAxisThatDropsOutTakesAllBackToTheApproach) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 2e-4);
  for (int n = 0; n < 3; ++n) static_cast<void>(bench.coordinator.update(0, {3e-4, 0, true}));
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
}

TEST(KickCoordinator, AnAxisThatRunsBeforeTheFirstOneDoesIsHeldInStepWithTheKick) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.coordinator.update(1, {5e-6, 0, true});
  double held_before_N = 0;
  for (int n = 0; n < 100 && !bench.outputs[0].kicked; ++n) {
    held_before_N = bench.force_N(1);
    bench.step(3e-4, 5e-6);
  }
  ASSERT_TRUE(bench.outputs[0].kicked);
  EXPECT_EQ(held_before_N, 0) << "a hold-off force before its kick";
  EXPECT_DOUBLE_EQ(bench.force_N(1), 0.25 * (bench.force_N(0) + 3.5));
}

TEST(KickCoordinator, ANewTargetIsApproachedFromTheHold) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(50, 5e-6, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  bench.coordinator.shift_target(1, 0.01);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
  bench.step(5e-6, 5e-6 - 0.01);
  EXPECT_DOUBLE_EQ(bench.force_N(1), -400 * (5e-6 - 0.01)) << "the target jumped, and not the axis";
}

TEST(KickCoordinator, AMissingSampleIsWaitedForBeforeAKickIsChosen) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 5e-6);
  bench.steps(40, 5e-6, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  bench.coordinator.update(0, {nan, 0, false});
  bench.coordinator.update(1, {5e-6, 0, true});
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
}

TEST(CoordinatedAxis, IsTheLawOfOneAxis) {
  const Parameters p = two_axes();
  Coordinator coordinator{p};
  CoordinatedAxis<double, 4> first{coordinator, 0}, second{coordinator, 1};
  EXPECT_EQ(first.period_s(), 1e-3);
  EXPECT_EQ(second.max_force_N(), 50);
  EXPECT_EQ(first.mode(), Mode::approach);
  for (int n = 0; n < 50; ++n) first.update({5e-6, 0, true}), second.update({0, 0, true});
  EXPECT_EQ(first.mode(), Mode::hold);
  second.reset();
  EXPECT_EQ(first.mode(), Mode::approach);
}

}  // namespace
}  // namespace breakaway::law
