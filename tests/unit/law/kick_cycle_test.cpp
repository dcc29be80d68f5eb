// The coast "brake" in the controller: the parts of a kick, and each guard against an axis that is not what was stated.
#include "breakaway/law/kick_cycle.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "../../kicked_axis.hpp"
#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::Moment;
using breakaway::testing::run_kicked_axis;
using breakaway::testing::TrueAxis;
using testing::braked_axis;
using testing::no_k3;
using testing::Scripted;

TEST(ForceInterval, HoldsTheForceOfEveryLagBetweenItsBounds) {
  std::mt19937_64 random{1};
  std::uniform_real_distribution<> share{0, 1};
  for (int run = 0; run < 200; ++run) {
    const double fast = 0.9 * share(random), slow = fast + (0.99 - fast) * share(random);
    const double left = fast + (slow - fast) * share(random);
    ForceInterval<double> interval;
    double force = 0;
    for (int k = 0; k < 100; ++k) {
      const double command = 100 * (share(random) - 0.5);
      interval.follow(command, fast, slow);
      force = command + (force - command) * left;
      ASSERT_LE(interval.lower_N, force + 1e-9);
      ASSERT_GE(interval.upper_N, force - 1e-9);
    }
  }
}

TEST(ForceInterval, IsNoWiderThanTheLagsLeaveIt) {
  ForceInterval<double> interval;
  interval.follow(10, 0.25, 0.5);  // up: the slowest has come half the way, the fastest three quarters
  EXPECT_DOUBLE_EQ(interval.lower_N, 5);
  EXPECT_DOUBLE_EQ(interval.upper_N, 7.5);
  interval.follow(-10, 0.25, 0.5);  // down
  EXPECT_DOUBLE_EQ(interval.lower_N, -6.25);
  EXPECT_DOUBLE_EQ(interval.upper_N, -1.25);
  EXPECT_DOUBLE_EQ(interval.along(-1).lower_N, 1.25);
  EXPECT_DOUBLE_EQ(interval.along(-1).upper_N, 6.25);
}

TEST(KickCycle, BrakesWithLessThanTheLeastFrictionAfterThePulse) {
  Scripted axis{0};
  EXPECT_GT(axis.pulse_at(-1e-4F), 4.5F);
  for (int i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(axis.show(-1e-4F + 1e-5F * static_cast<float>(i + 1)).force_N, -2.25F);
}

TEST(KickCycle, KicksTowardsTheTargetFromBothSidesAlike) {
  Scripted left{1e-3}, right{1e-3};
  const float to_the_right_N = left.pulse_at(-3e-5F);
  EXPECT_GT(to_the_right_N, 4.5F);
  EXPECT_EQ(to_the_right_N, -right.pulse_at(3e-5F));
}

TEST(KickCycle, CutsTheForceOfALaggingLoopAndNeverPullsBack) {
  const double lag_s = 2e-3, left = std::exp(-1e-3 / lag_s);
  Scripted axis{lag_s};
  double force_N = 0, most_N = 0;
  for (int i = 0; i < 400 && axis.controller().kicks() < 2; ++i) {
    const auto out = axis.show(-2e-4F);
    force_N = static_cast<double>(out.force_N) + (force_N - static_cast<double>(out.force_N)) * left;
    most_N = std::max(most_N, force_N);
    // After the approach has given up the force is never below the brake's.
    if (axis.controller().kicks() > 0) {
      EXPECT_GE(force_N, -2.25 - 1e-4);
    }
  }
  EXPECT_GT(most_N, 4.5);
}

TEST(KickCycle, StartsThePulseFromAKnownForce) {
  const double lag_s = 5e-3, left = std::exp(-1e-3 / lag_s);
  Scripted axis{lag_s};
  double force_N = 0;
  for (int i = 0; i < 400; ++i) {
    const auto out = axis.show(-2e-4F);
    if (out.kicked) break;
    force_N = static_cast<double>(out.force_N) + (force_N - static_cast<double>(out.force_N)) * left;
  }
  EXPECT_GE(force_N, static_cast<double>(axis.kicks().preload_N) - 1e-4);
  EXPECT_LE(force_N, 2.25 + 1e-4);
}

TEST(KickCycle, EndsAPulseOnTimeWhenSamplesAreLost) {
  Scripted seen{1e-3}, blind{1e-3};
  EXPECT_GT(seen.pulse_at(-5e-3F), 4.5F);
  EXPECT_GT(blind.pulse_at(-5e-3F), 4.5F);
  float last_N = 0;
  for (int i = 0; i < 8; ++i) {
    last_N = seen.show(-5e-3F).force_N;
    EXPECT_EQ(last_N, blind.lose().force_N) << i;
  }
  EXPECT_FLOAT_EQ(last_N, -2.25F) << "it brakes by then";
}

TEST(KickCycle, TakesTheBrakeOffAnAxisThatItDrivesBack) {
  Scripted axis{0};
  axis.pulse_at(-1e-4F);
  axis.show(-9e-5F);
  axis.show(-8e-5F);
  EXPECT_FLOAT_EQ(axis.show(-8.2e-5F).force_N, -2.25F);  // two counts back may be noise
  EXPECT_EQ(axis.show(-8.3e-5F).force_N, 0);
  EXPECT_EQ(axis.show(-8.4e-5F).force_N, 0);
}

TEST(KickCycle, TakesTheBrakeOffAfterTheLongestLawfulCoast) {
  Scripted axis{0};
  axis.pulse_at(-1e-4F);
  float position_m = -1e-4F, force_N = -1;
  int periods = 0;
  for (; periods < 200 && force_N != 0; ++periods) force_N = axis.show(position_m += 2e-6F).force_N;
  EXPECT_EQ(force_N, 0);
  EXPECT_GT(periods, 5);
}

TEST(KickCycle, TakesLongerToProveRestOnceTheBrakeIsOff) {
  const auto periods_to_next_kick = [](bool driven_back) {
    Scripted axis{0};
    axis.pulse_at(-1e-4F);
    axis.show(-8e-5F);
    const float end_m = driven_back ? -8.4e-5F : -8e-5F;
    axis.show(end_m);
    int periods = 0;
    while (!axis.show(end_m).kicked) ++periods;
    return periods;
  };
  EXPECT_GT(periods_to_next_kick(true), periods_to_next_kick(false) + 2);
}

// A brake of so many steps is not the same number in double, in float, and as steps times a float.
// A weak force moves a heavy axis by less than a count in a long pulse.
TEST(KickCycle, TakesALongPulseWithinOneCountForNoRest) {
  const BrakedKicks<float> kicks = design::design_braked_kicks<float>(axes_of_the_scenes(0)).kicks;
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  const auto periods = static_cast<std::uint8_t>(kicks.patient_periods + 5);
  ASSERT_GT(periods, kicks.patient_periods);
  cycle.see(0);
  cycle.kick(1, {5, periods, 0});
  for (int k = 0; k < periods; ++k) {
    cycle.next_steps(0);
    cycle.see(0);
    EXPECT_FALSE(cycle.at_rest()) << k;
  }
  int braked = 0;
  for (; !cycle.at_rest() && braked < 1000; ++braked) {
    cycle.next_steps(0);
    cycle.see(0);
  }
  EXPECT_GE(braked, kicks.still_periods + 1);
  EXPECT_LT(braked, kicks.patient_periods);
}

TEST(KickCycle, SeesRestUnderTheBrakeWhateverTheStepOfForce) {
  for (const double step_N : {0.025, 0.03, 0.12, 0.3, 0.0478, 0.0613}) {
    design::BrakedClass c = axes_of_the_scenes(0);
    c.force_step_N = step_N;
    const auto kicks = design::design_braked_kicks<float>(c).kicks;
    AxisController<float> controller{braked_axis(), no_k3, kicks};
    while (controller.kicks() == 0) controller.update({-1e-4F});
    int braked = 0;
    for (; controller.kicks() == 1 && braked < 100; ++braked) controller.update({-1e-4F});
    // One more for each of the latency, the period that the first reading ends, and the pulse.
    EXPECT_LE(braked, kicks.still_periods + 3) << step_N;
  }
}

TEST(KickCycle, MakesNoForceOfANumberThatIsNone) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(0)).kicks;
  const KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  EXPECT_EQ(cycle.whole_steps(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(cycle.whole_steps(std::numeric_limits<float>::infinity()), 32767);
  EXPECT_EQ(cycle.whole_steps(-std::numeric_limits<float>::infinity()), -32767);
}

// A counter-example of the campaign (axis 10924): hard braking behind a lag leaves more force than the brake's, from
// which a pulse would go further than its table says.
TEST(KickCycle, StartsAPulseFromNoMoreThanTheForceOfTheBrake) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(2e-3)).kicks;
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  for (int i = 0; i < 10; ++i) cycle.next_steps(2000);
  cycle.kick(1, {20, 2, 1});
  ForceInterval<float> before{};
  for (int i = 0; i < 100 && !cycle.pulse_starts(); ++i) {
    before = cycle.interval();
    cycle.next_steps(0);
  }
  EXPECT_TRUE(cycle.pulse_starts());
  EXPECT_LE(before.upper_N, kicks.brake_N + (kicks.holding_force_N - kicks.brake_N) / 32);
  EXPECT_GE(before.lower_N, kicks.preload_N);
}

TEST(KickCycle, NamesAnAxisThatDoesNotStopWithoutForce) {
  Scripted axis{0};
  axis.pulse_at(-1e-4F);
  float position_m = -1e-4F;
  int periods = 0;
  for (; periods < 2000 && axis.controller().fault() == ControlFault::none; ++periods) axis.show(position_m += 5e-6F);
  EXPECT_EQ(axis.controller().fault(), ControlFault::drifting);
  EXPECT_LT(periods, 1000);
}

// A force left over from a hard approach, either way, might move the axis still.
TEST(KickCycle, ProvesNoRestBeforeTheForceIsSureToHoldTheAxisEitherWay) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(2e-3)).kicks;
  for (const int steps : {2000, -2000}) {
    KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
    for (int i = 0; i < 20; ++i) cycle.next_steps(steps);
    cycle.release(100);
    cycle.see(0);
    int periods = 0, held = 0;
    for (; !cycle.at_rest() && periods < 1000; ++periods) {
      const ForceInterval<float> u = cycle.interval();
      if (u.upper_N <= kicks.holding_force_N && u.lower_N >= -kicks.holding_force_N) ++held;
      cycle.next_steps(0);
      cycle.see(0);
    }
    EXPECT_EQ(held, kicks.either_way_periods + 1) << "and one for the latency";
    EXPECT_GT(periods, held) << "not before";
  }
}

// The target moves in the period in which a pulse begins.
TEST(KickCycle, TellsOfNoPulseOnceItBeginsAnew) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(0)).kicks;
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.see(0);
  cycle.kick(1, {10, 3, 0});
  cycle.next_steps(0);
  ASSERT_TRUE(cycle.pulse_starts());
  cycle.restart();
  cycle.next_free_steps(0);
  EXPECT_FALSE(cycle.pulse_starts());
  EXPECT_FALSE(cycle.pulsed());
}

// A drive whose limit was lowered may never get to where a pulse is to start from.
TEST(KickCycle, GivesThePulseAllTheSameOnceItsForceHadTheTimeToSettle) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.limit_force(0);
  cycle.see(0);
  cycle.kick(1, {10, 3, 0});
  int periods = 0;
  do {
    cycle.next_steps(0);
  } while (++periods < 10000 && !cycle.pulse_starts());
  EXPECT_EQ(periods, kicks.patient_periods + kicks.settling_periods + 1);
}

TEST(KickCycle, IsOverdueAfterFourTimesWhatItsRestMayTake) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  KickCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.see(0);
  cycle.release(100);
  int periods = 0;
  for (; !cycle.overdue() && periods < 100000; ++periods) EXPECT_EQ(cycle.next_steps(7), 0);
  EXPECT_EQ(periods, 4 * (100 + kicks.patient_periods + kicks.settling_periods));
}

}  // namespace
}  // namespace breakaway::law
