// Axes that are approached together and let go: how they run in step, and what of them drops out or is lost on the way.
#include <gtest/gtest.h>

#include <cstddef>

#include "breakaway/law/coordinated_axis.hpp"
#include "coordinator_fixture.hpp"

namespace breakaway::law::coordinator_test {
namespace {

TEST(KickCoordinator, ApproachesEveryAxisWithItsGains) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, -0.05, 0.03);
  EXPECT_DOUBLE_EQ(bench.force_N(0), 20);
  EXPECT_DOUBLE_EQ(bench.force_N(1), -12);
  bench.step(-0.049, 0.03);
  EXPECT_NEAR(bench.force_N(0), 400 * 0.049 - 40 * 1.0, 1e-12);
  EXPECT_EQ(bench.outputs[0].mode, Mode::approach);
  EXPECT_EQ(bench.outputs[0].impulse_Ns, 0);
  EXPECT_EQ(bench.coordinator.kicks(), 0U);
}

TEST(KickCoordinator, GivesNoForceBeforeEveryAxisWasAskedInOnePeriod) {
  const Parameters p = two_axes();
  Coordinator coordinator{p};
  for (int n = 0; n < 20; ++n) EXPECT_EQ(coordinator.update(1, {0.03, 0, true}).force_N, 0) << "alone";
  EXPECT_EQ(coordinator.phase(), CoordinatorPhase::gather);
  EXPECT_EQ(coordinator.update(0, {-0.05, 0, true}).force_N, 0);
  EXPECT_EQ(coordinator.update(1, {0.03, 0, true}).force_N, 0);
  EXPECT_DOUBLE_EQ(coordinator.update(0, {-0.05, 0, true}).force_N, 20);
  EXPECT_DOUBLE_EQ(coordinator.update(1, {0.03, 0, true}).force_N, -12);
}

TEST(KickCoordinator, LetsGoOnceEveryAxisIsStillAndWithinItsGate) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(20, 0.03, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach) << "the first is outside its gate";
  bench.steps(20, -0.03, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach) << "on either side";
  bench.step(0.01, 0.001);
  bench.steps(2, 0.01, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
  bench.step(0.01, 0.001);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
  for (int n = 0; n < p.release_periods; ++n) {
    bench.step(0.01, 0.001);
    EXPECT_EQ(bench.force_N(0), 0);
    EXPECT_EQ(bench.force_N(1), 0);
    EXPECT_EQ(bench.outputs[0].impulse_Ns, 0);
  }
  bench.step(0.01, 0.001);
  EXPECT_NE(bench.force_N(0), 0);
}

TEST(KickCoordinator, WhereOneAxisDropsOutTheOthersHaveNoForceUntilItIsBack) {
  const Parameters p = two_axes();
  for (const std::size_t left : {0UL, 1UL}) {
    Bench bench{p};
    bench.steps(50, 5e-6, 5e-6);
    ASSERT_EQ(bench.coordinator.end(), CoordinatorEnd::on_target);
    bench.to_kick(3e-4, 2e-4);
    static_cast<void>(bench.coordinator.update(left, {3e-4, 0, true}));
    for (int n = 0; n < 30; ++n) EXPECT_EQ(bench.coordinator.update(left, {3e-4, 0, true}).force_N, 0) << n;
    EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::gather);
    EXPECT_EQ(bench.coordinator.end(), CoordinatorEnd::none);
    EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
    bench.steps(2, 3e-4, 2e-4);
    EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
  }
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

TEST(KickCoordinator, AnApproachThatBeginsWithALostSampleGivesNoForceOfAnOldOne) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, 0.05, 5e-6);
  ASSERT_NE(bench.force_N(0), 0);
  bench.steps(100, 5e-6, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  bench.coordinator.shift_target(1, 0.01);
  EXPECT_EQ(bench.coordinator.update(0, {nan, 0, false}).force_N, 0);
}

TEST(KickCoordinator, EveryApproachWaitsUntilTheAxesAreStill) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(50, 5e-6, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  bench.coordinator.shift_target(0, 1e-3);
  bench.steps(p.still_periods - 1, 5e-6 - 1e-3, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach) << "its new target is within the gate";
  bench.step(5e-6 - 1e-3, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
  bench.coordinator.shift_target(0, 1e-3);
  bench.steps(p.still_periods - 1, 5e-6 - 2e-3, 5e-6);
  bench.coordinator.update(0, {nan, 0, false});
  bench.coordinator.update(1, {5e-6, 0, true});
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach) << "a lost sample is no sign of standstill";
  bench.step(5e-6 - 2e-3, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
  EXPECT_EQ(bench.outputs[0].mode, Mode::approach);
  bench.step(5e-6 - 2e-3, 5e-6);
  EXPECT_EQ(bench.outputs[0].mode, Mode::coast);
}

TEST(KickCoordinator, AnAxisThatDroppedOutOnTheWayDelaysNoStandstillAfterIt) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, 0.03, 5e-6);
  bench.coordinator.update(0, {0.03, 0, true});
  bench.coordinator.update(0, {0.01, 0, true});
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::gather);
  bench.coordinator.shift_target(0, 0);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::gather) << "whatever their targets";
  bench.steps(p.still_periods, 0.01, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
  bench.step(0.01, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
}

TEST(KickCoordinator, AResetWithinAPeriodBeginsAWholeOne) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, 0.05, 5e-6);
  bench.coordinator.update(0, {0.05, 0, true});
  bench.coordinator.reset(0);
  EXPECT_EQ(bench.coordinator.update(1, {5e-6, 0, true}).force_N, 0);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::gather);
}

TEST(KickCoordinator, DampsByReadingsOfThisRunOnly) {
  const Parameters p = two_axes();
  Bench blind{p};
  blind.coordinator.update(0, {nan, 0, false});
  blind.coordinator.update(1, {0.03, 0, true});
  blind.step(-0.05, 0.03);
  EXPECT_DOUBLE_EQ(blind.force_N(0), 20) << "its first reading";
  Bench bench{p};
  bench.step(-0.05, 0.03);
  bench.step(-0.049, 0.03);
  EXPECT_NEAR(bench.force_N(0), 400 * 0.049 - 40 * 1.0, 1e-12) << "by the reading of the gathering, too";
  bench.coordinator.reset(0);
  bench.coordinator.update(0, {nan, 0, false});
  bench.coordinator.update(1, {0.03, 0, true});
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach);
  bench.step(-0.04, 0.03);
  EXPECT_DOUBLE_EQ(bench.force_N(0), 16) << "a reset forgets the reading";
  bench.step(-0.0395, 0.03);
  EXPECT_NEAR(bench.force_N(0), 400 * 0.0395 - 40 * 0.5, 1e-12);
}

TEST(KickCoordinator, ALostSampleOfAnApproachLeavesItsForceAsItWas) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, -0.05, 0.03);
  const auto out = bench.coordinator.update(0, {nan, 0, false});
  EXPECT_DOUBLE_EQ(out.force_N, 20);
  EXPECT_EQ(out.mode, Mode::approach);
  EXPECT_EQ(out.impulse_Ns, 0);
  EXPECT_FALSE(out.kicked);
}

TEST(KickCoordinator, NoKickIsChosenByASampleFromBeforeTheRelease) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(50, 5e-6, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  bench.step(-0.03, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::approach) << "something pushed it";
  bench.steps(p.still_periods + 1, 1e-3, 5e-6);
  ASSERT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
  for (int n = 0; n < p.release_periods; ++n) {
    bench.coordinator.update(0, {nan, 0, false});
    bench.coordinator.update(1, {5e-6, 0, true});
  }
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::release);
  bench.step(1e-3, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::pulse) << "once it was seen";
}

// An encoder that stands still, or an axis that is held: its force would go on for ever.
TEST(KickCoordinator, AMachineThatStandsBeyondAGateIsJammed) {
  const Parameters p = two_axes();
  // Four times D/P, twice the release, and what an approach that ends needs.
  constexpr int patience = 400 + 2 * 5 + 3;
  Bench bench{p};
  bench.steps(patience, -0.05, 1e-3);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
  EXPECT_NE(bench.force_N(0), 0);
  for (int n = 0; n < 3; ++n) bench.step(-0.05 + n % 2 * 1e-6, 1e-3);  // it flickers
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::jammed);
  bench.step(-0.05, 1e-3);
  EXPECT_EQ(bench.force_N(0), 0);
}

// One that moves may hold another one for a while, but not for three times as long.
TEST(KickCoordinator, AnAxisThatStandsBeyondItsGateWhileAnotherOneMovesIsJammedLater) {
  const Parameters p = two_axes();
  constexpr int patience = 3 * (401 + 2 * 5 + 3);
  Bench bench{p};
  const auto creep = [&](int from, int to) {
    for (int n = from; n < to; ++n) bench.step(-0.05, 1e-3 - n / 100 * 2e-6);
  };
  creep(0, patience - 10);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
  creep(patience - 10, patience + 10);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::jammed);
}

TEST(KickCoordinator, AnApproachThatBeginsAnewHasAllItsPatience) {
  const Parameters p = two_axes();
  Bench bench{p};
  for (int n = 0; n < 20; ++n) {
    bench.steps(350, -0.05, 1e-3);
    bench.coordinator.reset(0);
  }
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
}

TEST(KickCoordinator, PeriodsWithoutASampleSayNothingOfWhetherAMachineStands) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(10, -0.05, 1e-3);
  for (int n = 0; n < 1000; ++n) {
    bench.coordinator.update(0, {0, 0, false});
    bench.coordinator.update(1, {1e-3, 0, true});
  }
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
}

TEST(CoordinatedAxis, IsTheLawOfOneAxis) {
  const Parameters p = two_axes();
  Coordinator coordinator{p};
  CoordinatedAxis<double, 4> first{coordinator, 0}, second{coordinator, 1};
  EXPECT_EQ(first.period_s(), 1e-3);
  EXPECT_EQ(second.max_force_N(), 50);
  EXPECT_EQ(first.mode(), Mode::approach);
  const auto step = [&] { first.update({5e-6, 0, true}), second.update({0, 0, true}); };
  for (int n = 0; n < 1 + p.still_periods; ++n) {
    EXPECT_EQ(first.mode(), Mode::approach);
    step();
  }
  EXPECT_EQ(first.mode(), Mode::coast);
  for (int n = 0; n < 50; ++n) step();
  EXPECT_EQ(first.mode(), Mode::hold);
  second.reset();
  EXPECT_EQ(first.mode(), Mode::approach);
  EXPECT_EQ(first.encoder_resolution_m(), 1e-6);
  for (int n = 0; n < 50; ++n) step();
  ASSERT_EQ(second.mode(), Mode::hold);
  second.shift_target(0.01);
  EXPECT_EQ(first.mode(), Mode::approach);
  second.limit_force(3);
  first.update({5e-6, 0, true});
  EXPECT_EQ(second.update({-1, 0, true}).force_N, 3);
  first.update({nan, 0, true});
  EXPECT_EQ(second.fault(), ControlFault::none) << "it is not the second one's alone";
  EXPECT_EQ(second.update({-1, 0, true}).force_N, 0);
  for (const auto* axis : {&first, &second}) {
    EXPECT_EQ(axis->fault(), ControlFault::not_a_number);
    EXPECT_EQ(axis->mode(), Mode::fault);
  }
}

}  // namespace
}  // namespace breakaway::law::coordinator_test
