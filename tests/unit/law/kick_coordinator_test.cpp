// The kicks of axes that push each other: whom they are chosen for, how far they go, and what ends them.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "coordinator_fixture.hpp"

namespace breakaway::law::coordinator_test {
namespace {

TEST(KickCoordinator, AKickGoesAsFarAsItAimsUnderTheLeastFrictionAndTheOtherAxisIsHeld) {
  const Parameters p = two_axes();
  for (const double distance_m : {3e-4, 1.34e-4}) {  // the largest kick of one period goes 1.27e-4
    Bench bench{p};
    bench.to_kick(-distance_m, 5e-6);
    const double force_N = bench.force_N(0);
    ASSERT_TRUE(bench.outputs[0].kicked);
    EXPECT_EQ(bench.outputs[0].mode, Mode::kick);
    EXPECT_GT(force_N, 4.51);
    EXPECT_LE(force_N, 40);
    EXPECT_DOUBLE_EQ(bench.force_N(1), 0.25 * (force_N - 3.5));
    EXPECT_EQ(bench.outputs[1].impulse_Ns, 0);
    int periods = 1;
    for (bench.step(-distance_m, 5e-6); bench.outputs[0].mode == Mode::kick; bench.step(-distance_m, 5e-6)) {
      EXPECT_FALSE(bench.outputs[0].kicked);
      ++periods;
    }
    const double t_s = periods * p.period_s;
    EXPECT_NEAR((force_N - 2.5) * (force_N + 0.5) * t_s * t_s / (2 * 2 * 3), distance_m - 0.5e-6, 1e-12);
    EXPECT_DOUBLE_EQ(bench.force_N(0), -0.5);
    EXPECT_DOUBLE_EQ(bench.force_N(1), -0.25 * (4.5 + 0.5) / 2);
  }
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
  bench.to_kick(5e-6, 3e-4);
  EXPECT_EQ(bench.coordinator.kicks(), 1U) << "something pushed it: a budget of its own";
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
  Bench back{p};
  back.to_kick(3e-4, 2e-4);
  back.steps(200, 1e-4, 1.97e-4);
  EXPECT_EQ(back.coordinator.moved(), 1U) << "either way";
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

TEST(KickCoordinator, ADriveThatGivesJustEnoughKicks) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.coordinator.limit_force(0, p.axes[0].sure_N);
  bench.to_kick(3e-4, 0);
  EXPECT_EQ(bench.force_N(0), -p.axes[0].sure_N);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
}

TEST(KickCoordinator, ADriveThatNoLongerHoldsItsAxisWhileAnotherOneIsKickedIsNamedBeforeTheKick) {
  const Parameters p = two_axes();
  for (const double limit_N : {0.25 * 36.4, 0.25 * 36.6}) {
    Bench bench{p};
    bench.coordinator.limit_force(1, limit_N);
    bench.steps(3000, 3e-4, 5e-6);
    const bool weak = limit_N < 0.25 * (p.axes[0].kick_N - 3.5);
    EXPECT_EQ(bench.coordinator.kicks(), weak ? 0U : 10U);
    EXPECT_EQ(bench.coordinator.fault(), weak ? ControlFault::jammed : ControlFault::hunting);
    bench.coordinator.reset(1);
    EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
    bench.steps(3000, 3e-4, 5e-6);
    EXPECT_EQ(bench.coordinator.fault(), ControlFault::hunting) << "the drive gives all again";
  }
}

// In float, with the least mass and friction, from the very edge of a count.
TEST(KickCoordinator, NoRoundingTakesAKickBeyondItsTarget) {
  std::mt19937 random{1};  // NOLINT: the same kicks every time
  const auto share = [&] { return std::uniform_real_distribution<float>{0, 1}(random); };
  for (int trial = 0; trial < 20000; ++trial) {
    const float lower_N = 2 + 10 * share(), upper_N = lower_N * (1 + share() * share());
    CoordinatorParameters<float, 2> p;
    p.count = 1, p.period_s = 1e-3F, p.still_periods = 1, p.most_kicks = 10;
    p.axes[0] = {.position_gain_N_per_m = 1,
                 .velocity_gain_Ns_per_m = 1,
                 .mass_kg = std::pow(10.0F, 2 * share() - 1),
                 .lower_N = lower_N,
                 .upper_N = upper_N,
                 .sure_N = 1.002F * upper_N,
                 .brake_N = trial % 2 == 0 ? 0 : lower_N * share() / 2,
                 .kick_N = upper_N * (1.1F + 20 * share()),
                 .max_force_N = 1e3,
                 .gate_m = 1,
                 .tolerance_m = 1e-6F,
                 .resolution_m = 1e-6F,
                 .hold_off = {}};
    const double counts = std::round(std::pow(10.0F, 5 * share())) + 1, distance_m = (counts - 0.5) * 1e-6;
    const auto& a = p.axes[0];
    KickCoordinator<float, 2> coordinator{p};
    double force_N = 0;
    int periods = 0;
    for (int n = 0; n < 300; ++n) {
      const auto output = coordinator.update(0, {static_cast<float>(-counts) * 1e-6F, 0, true});
      if (output.mode != Mode::kick && periods > 0) break;
      if (output.mode == Mode::kick) ++periods, force_N = double{output.force_N};
    }
    if (periods == 0) continue;  // below the floor
    const double t_s = periods * 1e-3, g_N = double{a.lower_N} + double{a.brake_N};
    const double travel_m =
        (force_N - double{a.lower_N}) * (force_N + double{a.brake_N}) * t_s * t_s / (2 * double{a.mass_kg} * g_N);
    ASSERT_LE(travel_m, distance_m) << "trial " << trial;
  }
}

TEST(KickCoordinator, ForcesStayWithinTheLimitOfEveryDrive) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, -10, 10);
  EXPECT_EQ(bench.force_N(0), 50);
  EXPECT_EQ(bench.force_N(1), -50);
}

TEST(KickCoordinator, AReadingThatIsNoNumberStopsAllForces) {
  const Parameters p = two_axes();
  Bench far{p}, kicks{p}, holds{p};
  far.steps(2, 0.05, 0.05);
  kicks.to_kick(3e-4, 2e-4);
  holds.steps(50, 5e-6, 5e-6);
  for (Bench* bench : {&far, &kicks, &holds}) {
    bench->step(3e-4, nan);
    EXPECT_EQ(bench->outputs[1].mode, Mode::fault);
    EXPECT_EQ(bench->force_N(1), 0);
    bench->step(3e-4, 2e-4);
    EXPECT_EQ(bench->coordinator.fault(), ControlFault::not_a_number);
    EXPECT_EQ(bench->force_N(0), 0);
    bench->coordinator.shift_target(0, 1e-3);
    EXPECT_EQ(bench->coordinator.phase(), CoordinatorPhase::fault) << "a new target ends no fault";
  }
}

TEST(KickCoordinator, ItsFirstFaultIsTheOneThatIsNamed) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 2e-4);
  bench.steps(200, 1e-4, 2.03e-4);
  ASSERT_EQ(bench.coordinator.fault(), ControlFault::contradicted);
  bench.step(nan, nan);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::contradicted);
}

// The loop looks at it before each axis' turn: one that saw it in the same period would be named for another's fault.
TEST(KickCoordinator, AFaultOfTheFirstAxisIsShownToAllInOnePeriod) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, -0.05, 1e-3);
  bench.coordinator.update(0, {nan, 0, true});
  EXPECT_EQ(bench.coordinator.shown_fault(), ControlFault::none);
  EXPECT_EQ(bench.coordinator.update(1, {1e-3, 0, true}).force_N, 0) << "no force meanwhile";
  EXPECT_EQ(bench.coordinator.shown_fault(), ControlFault::not_a_number);
  bench.coordinator.reset(0);
  EXPECT_EQ(bench.coordinator.shown_fault(), ControlFault::none);
  Bench alone{p};
  alone.steps(2, -0.05, 1e-3);
  alone.coordinator.update(0, {nan, 0, true});
  alone.coordinator.update(0, {nan, 0, true});
  EXPECT_EQ(alone.coordinator.shown_fault(), ControlFault::not_a_number) << "though the other one is asked no more";
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

TEST(KickCoordinator, AKickIsAimedFromReadingsOfTheMachineAtRestThoughSamplesAreLostAsTheReleaseEnds) {
  const Parameters p = two_axes();
  Bench bench{p};
  while (bench.coordinator.phase() != CoordinatorPhase::release) bench.step(3e-4, 5e-6);
  bench.step(3e-4, 5e-6);
  for (int n = 0; n < 10; ++n) {  // the springs move it meanwhile
    bench.coordinator.update(0, {nan, 0, false});
    bench.coordinator.update(1, {5e-6, 0, true});
    EXPECT_EQ(bench.coordinator.kicks(), 0U);
  }
  for (int n = 0; n < 100; ++n) bench.step(5e-6, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  EXPECT_EQ(bench.coordinator.kicks(), 0U);
}

// One drive answers every odd SYNC and another every even one: no period brings readings of both.
TEST(KickCoordinator, SamplesThatAreLostNowOfOneAxisAndNowOfAnotherEndNothing) {
  const Parameters p = two_axes();
  Coordinator coordinator{p};
  unsigned n = 0;
  const auto kicked_at = [&](double first_m, double second_m) {
    for (int patience = 0; patience < 300; ++patience) {
      const bool first = (++n & 1U) != 0;
      const bool kicked = coordinator.update(0, {first ? first_m : nan, 0, first}).kicked;
      if (coordinator.update(1, {first ? nan : second_m, 0, !first}).kicked || kicked) return true;
    }
    return false;
  };
  EXPECT_TRUE(kicked_at(3e-4, 2e-4)) << "the approach ends";
  EXPECT_TRUE(kicked_at(5e-6, 2e-4)) << "a kick is judged";
  EXPECT_FALSE(kicked_at(5e-6, 5e-6));
  EXPECT_EQ(coordinator.phase(), CoordinatorPhase::hold);
  EXPECT_TRUE(kicked_at(5e-6, 2e-4)) << "something pushes an axis that is held";
  EXPECT_EQ(coordinator.fault(), ControlFault::none);
}

TEST(KickCoordinator, ASampleThatIsLostAsAKickStartsIsNoSignOfMotion) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(5e-6, 3e-4);
  ASSERT_EQ(bench.coordinator.kicked(), 1U);
  for (int n = 0; n < 300 && bench.coordinator.phase() != CoordinatorPhase::rest; ++n) bench.step(5e-6, 1e-4);
  // The first axis is to be kicked next, while the second one stands elsewhere than at its own kick.
  bench.coordinator.shift_target(0, -1e-3);
  bool kicked = false;
  for (int n = 0; n < 300 && !kicked; ++n) {
    const bool about_to = bench.coordinator.phase() == CoordinatorPhase::pulse;
    kicked = bench.coordinator.update(0, {1e-3, 0, true}).kicked;
    bench.coordinator.update(1, {5e-6, 0, !about_to});
  }
  ASSERT_EQ(bench.coordinator.kicked(), 0U);
  for (int n = 0; n < 300 && bench.coordinator.phase() != CoordinatorPhase::hold; ++n) bench.step(5e-6, 5e-6);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
}

TEST(KickCoordinator, LooksAtOneAxisInAPeriodAndHoldsThoseThatItCannotKick) {
  Parameters p = two_axes();
  p.axes[0].tolerance_m = 1e-7;
  p.axes[0].resolution_m = 1e-8;
  Bench bench{p};
  int choices = 0;
  for (int n = 0; n < 100 && !bench.outputs[1].kicked; ++n) {
    bench.step(3e-7, 3e-4);
    if (bench.coordinator.phase() != CoordinatorPhase::choice) continue;
    ++choices;
    EXPECT_EQ(bench.force_N(1), 0);
  }
  EXPECT_EQ(choices, 1) << "the first axis had its turn";
  EXPECT_TRUE(bench.outputs[1].kicked);
  bench.steps(300, 3e-7, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  EXPECT_EQ(bench.coordinator.end(), CoordinatorEnd::below_floor);
}

TEST(KickCoordinator, AnAxisThatIsThereWhenItsTurnComesIsNotKicked) {
  Parameters p = two_axes();
  p.axes[0].tolerance_m = 1e-7;
  p.axes[0].resolution_m = 1e-8;
  Bench bench{p};
  for (int n = 0; n < 100 && bench.coordinator.phase() != CoordinatorPhase::choice; ++n) bench.step(3e-7, 3e-4);
  bench.steps(20, 3e-7, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
  EXPECT_EQ(bench.coordinator.kicks(), 0U);
}

TEST(KickCoordinator, WhetherAnotherAxisMovedIsSeenFromTheBeginningOfTheKick) {
  const Parameters p = two_axes();
  Bench bench{p};
  while (bench.coordinator.phase() != CoordinatorPhase::pulse) bench.step(3e-4, 5e-6);
  while (bench.coordinator.phase() != CoordinatorPhase::rest) bench.step(3e-4, 8e-6);
  bench.steps(2, 5e-6, 8e-6);
  EXPECT_EQ(bench.coordinator.fault(), ControlFault::none);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::hold);
}

TEST(KickCoordinator, AKickIsCountedAnewFromEveryRelease) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 5e-6);
  bench.to_kick(2e-4, 5e-6);
  ASSERT_EQ(bench.coordinator.kicks(), 2U);
  bench.coordinator.shift_target(0, 1e-3);
  EXPECT_EQ(bench.coordinator.end(), CoordinatorEnd::none);
  bench.to_kick(-8e-4, 5e-6);
  EXPECT_EQ(bench.coordinator.kicks(), 1U);
}

TEST(KickCoordinator, AKickIsJudgedOnceEveryAxisWasSeen) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 5e-6);
  while (bench.coordinator.phase() != CoordinatorPhase::rest) bench.step(3e-4, 5e-6);
  bench.step(3e-4, 5e-6);
  for (int n = 0; n < 10; ++n) {
    bench.coordinator.update(0, {3e-4, 0, true});
    bench.coordinator.update(1, {nan, 0, false});
    EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::rest);
  }
  bench.step(3e-4, 5e-6);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::pulse);
}

}  // namespace
}  // namespace breakaway::law::coordinator_test
