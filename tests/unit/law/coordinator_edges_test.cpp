// Ties, defaults and the ends of ranges: what is still within a limit, and how long each phase is at the most.
#include <gtest/gtest.h>

#include <limits>

#include "breakaway/law/coordinated_axis.hpp"
#include "coordinator_fixture.hpp"

namespace breakaway::law::coordinator_test {
namespace {

// Lengths of whole bits, so that a reading can be at the very limit.
Parameters axes_of_whole_bits() {
  Parameters p = two_axes();
  for (auto& a : p.axes) {
    a.resolution_m = 0x1p-20;
    a.tolerance_m = 0x1p-17;
    a.gate_m = 0x1p-6;
  }
  return p;
}

TEST(CoordinatorEdges, AReadingAtALimitIsWithinIt) {
  const Parameters p = axes_of_whole_bits();
  for (const double side : {1.0, -1.0}) {
    Bench gate{p};
    gate.steps(4, side * 0x1p-6, 0);
    EXPECT_EQ(gate.coordinator.phase(), CoordinatorPhase::release);
    Bench moves{p};
    for (int n = 0; n < 4; ++n) moves.step(n % 2 == 0 ? side * 0x1.8p-20 : 0, 0);
    EXPECT_EQ(moves.coordinator.phase(), CoordinatorPhase::release) << "a count and a half is still";
    Bench tolerance{p};
    tolerance.steps(20, side * 0x1p-17, 0);
    EXPECT_EQ(tolerance.coordinator.phase(), CoordinatorPhase::hold);
    tolerance.step(side * 0x1p-6, 0);
    EXPECT_NE(tolerance.coordinator.phase(), CoordinatorPhase::approach) << "at its gate it is kicked";
    Bench other{p};
    other.to_kick(side * 3e-4, 0);
    other.steps(200, 0, side * 0x1.8p-20);
    EXPECT_EQ(other.coordinator.fault(), ControlFault::none);
    Bench beyond{p};
    beyond.to_kick(side * 3e-4, 0);
    beyond.steps(200, -side * 0x1.8p-20, 0);
    EXPECT_EQ(beyond.coordinator.fault(), ControlFault::none);
  }
}

TEST(CoordinatorEdges, OnlyANumberIsAReading) {
  const Parameters p = two_axes();
  constexpr double most = std::numeric_limits<double>::max();
  for (const double number : {most, -most}) {
    Coordinator coordinator{p};
    coordinator.update(0, {number, 0, true});
    EXPECT_EQ(coordinator.fault(), ControlFault::none);
  }
  for (const double none : {2 * most, -2 * most, nan}) {
    Coordinator coordinator{p};
    const auto out = coordinator.update(0, {none, 0, true});
    EXPECT_EQ(coordinator.fault(), ControlFault::not_a_number);
    EXPECT_EQ(out.force_N, 0);
    EXPECT_EQ(out.impulse_Ns, 0);
    EXPECT_FALSE(out.kicked);
  }
}

TEST(CoordinatorEdges, AnAxisThatIsNotThereChangesNothing) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(3e-4, 2e-4);
  const double force_N = bench.force_N(0);
  const auto out = bench.coordinator.update(2, {1, 0, true});
  EXPECT_EQ(out.force_N, 0);
  bench.coordinator.shift_target(2, 1);
  bench.coordinator.reset(2);
  bench.coordinator.limit_force(2, 0);
  EXPECT_EQ(bench.coordinator.phase(), CoordinatorPhase::pulse);
  bench.step(3e-4, 2e-4);
  EXPECT_TRUE(bench.force_N(0) == force_N || bench.force_N(0) == 0.5);
  EXPECT_EQ(bench.outputs[0].impulse_Ns, 0);
  Parameters unlike = p;
  unlike.axes[1].position_gain_N_per_m = 100;
  Coordinator coordinator{unlike};
  CoordinatedAxis<double, 4> nobody{coordinator, 4};
  nobody.update({-0.05, 0, true});
  coordinator.update(1, {0, 0, true});
  EXPECT_EQ(nobody.update({-0.05, 0, true}).force_N, 20) << "is the first one";
}

TEST(CoordinatorEdges, AResetLeavesNoForceEvenWhereASampleIsLost) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.steps(2, -0.05, 0.03);
  bench.coordinator.limit_force(0, 7);
  bench.coordinator.reset(0);
  bench.step(-0.05, 0.03);
  EXPECT_EQ(bench.coordinator.update(0, {0, 0, false}).force_N, 0);
  EXPECT_EQ(bench.coordinator.update(1, {0.03, 0, true}).force_N, -12);
  bench.step(-0.05, 0.03);
  EXPECT_EQ(bench.force_N(0), 20) << "its drive gives all again";
}

TEST(CoordinatorEdges, WherePeriodsOfLessThanIsSureWouldBeRightItGivesOneLessWithAll) {
  Parameters p = two_axes();
  p.axes[0].kick_N = 4.6;
  p.axes[0].tolerance_m = 1e-7;
  p.axes[0].resolution_m = 1e-8;
  Bench bench{p};
  bench.to_kick(1.2e-6, 0);
  EXPECT_EQ(bench.force_N(0), -4.6 * (1 - 8 * std::numeric_limits<double>::epsilon())) << "but for its rounding";
  bench.step(1.2e-6, 0);
  EXPECT_NE(bench.outputs[0].mode, Mode::kick) << "one period";
}

TEST(CoordinatorEdges, NoPulseIsLongerThan255Periods) {
  Parameters p = two_axes();
  p.axes[0].gate_m = 100;
  Bench bench{p};
  bench.to_kick(20, 0);
  int periods = 1;
  EXPECT_EQ(bench.force_N(0), -40) << "with all that a kick may have";
  for (bench.step(20, 0); bench.outputs[0].mode == Mode::kick; bench.step(20, 0)) ++periods;
  EXPECT_EQ(periods, 255);
}

TEST(CoordinatorEdges, AsManyAxesAsItHasRoomForRunTogether) {
  using Wide = KickCoordinator<double, 32>;
  CoordinatorParameters<double, 32> p;
  EXPECT_EQ(p.count, 32);
  EXPECT_EQ(p.settling_periods, 2);
  EXPECT_EQ(p.still_periods, 8);
  EXPECT_EQ(p.release_periods, 0);
  EXPECT_EQ(p.most_kicks, 0U);
  p.period_s = 1e-3;
  for (auto& axis : p.axes) axis = an_axis<32>();
  Wide coordinator{p};
  const auto step = [&](std::size_t axes) {
    for (std::size_t i = 0; i < axes; ++i) coordinator.update(i, {0, 0, true});
  };
  EXPECT_EQ(coordinator.update(32, {1, 0, true}).force_N, 0);
  coordinator.limit_force(32, 1);
  coordinator.shift_target(32, 1);
  coordinator.reset(32);
  for (int n = 0; n < 20; ++n) step(31);
  EXPECT_EQ(coordinator.phase(), CoordinatorPhase::gather) << "the last one is missing";
  for (int n = 0; n < 1 + 8; ++n) step(32);
  EXPECT_EQ(coordinator.phase(), CoordinatorPhase::release);
  step(32);
  EXPECT_EQ(coordinator.phase(), CoordinatorPhase::hold) << "a release takes a period at least";
}

// How many periods each phase of one kick takes.
struct Lengths {
  int pulse = 0, coast = 0, rest = 0;
};
Lengths lengths_of_a_kick(Coordinator& coordinator, double at_m) {
  Lengths lengths;
  for (int n = 0; n < 70000; ++n) {
    const CoordinatorPhase phase = coordinator.phase();
    lengths.pulse += phase == CoordinatorPhase::pulse;
    lengths.coast += phase == CoordinatorPhase::coast;
    lengths.rest += phase == CoordinatorPhase::rest;
    coordinator.update(0, {at_m, 0, true});
    if (phase == CoordinatorPhase::rest && coordinator.phase() != phase) break;
  }
  return lengths;
}

TEST(CoordinatorEdges, ACoastOfWholePeriodsLastsSoManyAndThoseUntilItIsSeen) {
  Parameters p = two_axes();
  p.count = 1;
  p.axes[0].lower_N = 2;
  p.axes[0].brake_N = 0;
  Coordinator coordinator{p};
  coordinator.limit_force(0, 6);
  const Lengths lengths = lengths_of_a_kick(coordinator, -3e-4);
  EXPECT_EQ(lengths.pulse, 2);
  EXPECT_EQ(lengths.coast, 4 + 2) << "(6 - 2) 2/2";
  EXPECT_EQ(lengths.rest, 2);
}

TEST(CoordinatorEdges, NoCoastIsLongerThan65535Periods) {
  Parameters p = two_axes();
  p.count = 1;
  auto& a = p.axes[0];
  a.mass_kg = 2000, a.lower_N = 5e-4, a.brake_N = 0, a.upper_N = 6e-4, a.sure_N = 7e-4, a.kick_N = 50;
  Coordinator coordinator{p};
  const Lengths lengths = lengths_of_a_kick(coordinator, -1e-3);
  EXPECT_EQ(lengths.pulse, 1);
  EXPECT_EQ(lengths.coast, 65535 + 2);
}

TEST(CoordinatorEdges, AForceThatIsJustSureIsGiven) {
  const Parameters p = two_axes();
  Bench bench{p};
  bench.to_kick(-3e-4, 0);
  Parameters just_sure = p;
  just_sure.axes[0].sure_N = bench.force_N(0);
  Bench same{just_sure};
  same.to_kick(-3e-4, 0);
  EXPECT_EQ(same.force_N(0), bench.force_N(0));
  same.step(-3e-4, 0);
  EXPECT_EQ(same.outputs[0].mode, Mode::kick) << "two periods, as before";
  just_sure.axes[0].sure_N = just_sure.axes[0].kick_N;
  Bench largest{just_sure};
  largest.to_kick(-3e-4, 0);
  EXPECT_EQ(largest.force_N(0), 40) << "one period with all that there is";
  largest.step(-3e-4, 0);
  EXPECT_NE(largest.outputs[0].mode, Mode::kick);
}

TEST(CoordinatorEdges, ADriveThatGivesJustWhatHoldsItsAxisIsNotWeak) {
  Parameters p = two_axes();
  p.axes[2] = p.axes[0];
  p.axes[2].hold_off[1] = 100;  // it is not there, and asks for nothing
  for (const double share : {0.25, -0.25}) {
    p.axes[0].hold_off[1] = share;
    Bench enough{p}, weak{p};
    enough.coordinator.limit_force(1, 0.25 * 36.5);
    enough.steps(100, 3e-4, 5e-6);
    EXPECT_EQ(enough.coordinator.fault(), ControlFault::none);
    weak.coordinator.limit_force(1, 0.25 * 36.4);
    weak.coordinator.limit_force(1, 0.25 * 40);
    weak.steps(100, 3e-4, 5e-6);
    EXPECT_EQ(weak.coordinator.fault(), ControlFault::jammed) << "a limit is not lifted by a higher one";
  }
}

TEST(CoordinatorEdges, ADriveMayBeTooWeakForKicksOfAnAxisThatIsNeverKicked) {
  Parameters p = two_axes();
  p.count = 3;
  p.axes[2] = p.axes[1];
  p.axes[2].hold_off = {};
  p.axes[0].kick_N = 0;
  Coordinator coordinator{p};
  coordinator.limit_force(1, 0.5);
  for (int n = 0; n < 3000; ++n) {
    coordinator.update(0, {3e-4, 0, true});
    coordinator.update(1, {0, 0, true});
    coordinator.update(2, {3e-4, 0, true});
  }
  EXPECT_EQ(coordinator.kicked(), 2U);
  EXPECT_EQ(coordinator.kicks(), p.most_kicks);
}

TEST(CoordinatorEdges, AnAxisOfLessThanANewtonIsKickedAndHeldToo) {
  Parameters p = two_axes();
  auto& a = p.axes[0];
  a.mass_kg = 0.04, a.lower_N = 0.2, a.upper_N = 0.4, a.sure_N = 0.41, a.brake_N = 0.1, a.kick_N = 0.9;
  Bench bench{p}, weak{p};
  bench.to_kick(3e-4, 5e-6);
  EXPECT_TRUE(bench.outputs[0].kicked);
  weak.coordinator.limit_force(1, 0.1);
  weak.steps(100, 3e-4, 5e-6);
  EXPECT_EQ(weak.coordinator.fault(), ControlFault::jammed);
}

TEST(CoordinatorEdges, MoreAxesThanItHasRoomForAreNotThere) {
  Parameters p = two_axes();
  p.axes[2] = p.axes[3] = p.axes[1];
  p.count = 9;
  Coordinator coordinator{p};
  EXPECT_EQ(coordinator.update(4, {1, 0, true}).force_N, 0);
  for (int n = 0; n < 2; ++n) {
    for (std::size_t i = 0; i < 4; ++i) coordinator.update(i, {0, 0, true});
  }
  EXPECT_EQ(coordinator.phase(), CoordinatorPhase::approach);
}

}  // namespace
}  // namespace breakaway::law::coordinator_test
