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

TEST(BrakedKicks, AreNotUsableWithANumberThatIsNone) {
  using Kicks = BrakedKicks<float>;
  using Approach = BrakedApproach<float>;
  const Kicks sound = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  EXPECT_TRUE(are_usable(sound));
  for (float Kicks::*const number :
       {&Kicks::brake_N, &Kicks::force_step_N, &Kicks::preload_N, &Kicks::resting_force_N, &Kicks::holding_force_N,
        &Kicks::fast_lag, &Kicks::slow_lag, &Kicks::short_lag, &Kicks::coast_per_N, &Kicks::breakaway_N,
        &Kicks::lost_motion_m, &Kicks::least_seen_N, &Kicks::most_seen_N}) {
    Kicks spoiled = sound;
    spoiled.*number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(are_usable(spoiled));
  }
  for (float Approach::*const number :
       {&Approach::mass_kg, &Approach::friction_N, &Approach::hard_m_s2, &Approach::gentle_m_s2,
        &Approach::switch_speed_m_s, &Approach::switch_distance_m, &Approach::short_of_target_m, &Approach::response_s,
        &Approach::lag_s, &Approach::correction, &Approach::standing_m_s}) {
    Kicks spoiled = sound;
    spoiled.approach.*number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(are_usable(spoiled));
  }
}

TEST(BrakedKicks, AreNotUsableWithATravelThatIsNotSure) {
  using Sure = SureTravel<float>;
  const BrakedKicks<float> sound = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  for (float Sure::*const number : {&Sure::share, &Sure::from_m, &Sure::most_m}) {
    BrakedKicks<float> spoiled = sound;
    spoiled.sure.*number = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(are_usable(spoiled));
  }
  BrakedKicks<float> spoiled = sound;
  spoiled.sure.share = 1.01F;
  EXPECT_FALSE(are_usable(spoiled)) << "no kick is sure to go further than it aims";
}

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

TEST(KickCycle, ApproachesFromBothSidesAlike) {
  const auto from = [](double start_m, double start_m_s) {
    static const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
    TrueAxis truth;
    truth.lag_s = 1e-3;
    const auto friction = [](const Moment&) { return 3.5; };
    return run_kicked_axis<float>(braked_axis(), no_k3, kicks, truth, friction, start_m, start_m_s, 4, 4, 50, 0);
  };
  const auto left = from(-0.4, -0.5), right = from(0.4, 0.5);
  EXPECT_TRUE(left.held);
  EXPECT_EQ(left.time_s, right.time_s);
  EXPECT_EQ(left.kicks, right.kicks);
  EXPECT_EQ(left.error_m, -right.error_m);
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

// A force of 10 N brakes far less than the 50 N that the plan was made for.
TEST(KickCycle, BrakesAnApproachNoHarderThanALoweredLimitLetsIt) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(0)).kicks;
  AxisController<float> controller{braked_axis(), no_k3, kicks};
  controller.limit_force(10);
  breakaway::testing::Slider axis{TrueAxis{}, [](const breakaway::testing::Moment&) { return 2.5; }, -0.2, 0};
  double sample_m = axis.position_m(), furthest_m = sample_m;
  for (int i = 0; i < 2000 && controller.kicks() == 0 && controller.mode() != Mode::hold; ++i) {
    const auto out = controller.update({static_cast<float>(std::round(sample_m * 1e6) * 1e-6)});
    sample_m = axis.position_m();
    axis.run(static_cast<double>(out.force_N), 1e-3, 4);
    furthest_m = std::max(furthest_m, axis.position_m());
  }
  const auto& plan = kicks.approach;
  EXPECT_LE(furthest_m, static_cast<double>(plan.switch_distance_m + plan.short_of_target_m));
}

TEST(KickCycle, TellsTheSpeedWhenTheApproachIsOver) {
  Scripted axis{0};
  axis.pulse_at(-1e-4F);
  axis.show(-9e-5F);
  EXPECT_NEAR(axis.controller().velocity_m_s(), 0.01F, 1e-6F);
  axis.show(-9e-5F);
  EXPECT_EQ(axis.controller().velocity_m_s(), 0);
}

TEST(KickCycle, TellsAsWhatIsSureToMoveTheAxisTheGreatestFrictionAndForceBesideItByTheWeakestDrive) {
  design::BrakedClass c = axes_of_the_scenes(0);
  c.load_N = 0.5;
  c.force_gain = {0.9, 1.1};
  const auto kicks = design::design_braked_kicks<float>(c).kicks;
  const AxisController<float> controller{braked_axis(), no_k3, kicks};
  EXPECT_FLOAT_EQ(controller.breakaway_N(), 5 / 0.9F);
  EXPECT_EQ(controller.lost_motion_m(), 0);
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

// What acts on the axis is the same, so the law must be, too.
TEST(KickCycle, IsTheSameBesideAFeedforward) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  auto weighed = braked_axis();
  weighed.feedforward_N = -8;
  AxisController<float> alone{braked_axis(), no_k3, kicks}, beside{weighed, no_k3, kicks};
  EXPECT_EQ(beside.max_force_N(), alone.max_force_N() + 8);
  std::mt19937_64 random{11};
  float position_m = -1e-3F;
  for (int i = 0; i < 2000; ++i) {
    position_m += 1e-6F * static_cast<float>(random() % 3) - 1e-6F;
    const Measurement<float> reading{position_m, 0, random() % 50 != 0};
    const auto expected = alone.update(reading), given = beside.update(reading);
    ASSERT_EQ(given.mode, expected.mode) << i;
    ASSERT_EQ(given.force_N, expected.mode == Mode::fault ? 0 : expected.force_N - 8) << i;
  }
  beside.limit_force(30);
  for (int i = 0; i < 200; ++i) ASSERT_LE(std::fabs(beside.update({-3e-5F}).force_N), 30) << i;
  EXPECT_EQ(beside.update({std::numeric_limits<float>::quiet_NaN()}).force_N, 0);
}

// A limit below the feedforward leaves the law nothing, and a share of nothing is no number.
TEST(KickCycle, TakesALimitOfNothingTwice) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  auto weighed = braked_axis();
  weighed.feedforward_N = -8;
  AxisController<float> controller{weighed, no_k3, kicks};
  for (int i = 0; i < 3; ++i) controller.limit_force(5);
  for (int i = 0; i < 200; ++i) ASSERT_EQ(controller.update({-0.1F}).force_N, -8) << i;
  EXPECT_EQ(controller.fault(), ControlFault::none);
}

TEST(KickCycle, LatchesAFaultWhenTheSpeedOfTheApproachOverflows) {
  Scripted axis{1e-3};
  axis.show(0.01F);
  EXPECT_EQ(axis.show(3e38F).force_N, 0);
  EXPECT_EQ(axis.controller().fault(), ControlFault::not_a_number);
  axis.controller().reset();
  axis.show(0.01F);
  EXPECT_EQ(axis.show(0.01F).mode, Mode::approach) << "nothing of the overflow is left";
  EXPECT_EQ(axis.controller().velocity_m_s(), 0);
}

TEST(KickCycle, DoesAfterAResetTheSameWhateverItDidBefore) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  std::mt19937_64 random{17};
  AxisController<float> controller{braked_axis(), no_k3, kicks};
  for (int trial = 0; trial < 200; ++trial) {
    float x = 1e-6F * static_cast<float>(random() % 4000) - 2e-3F;
    const auto reading = [&] { return Measurement<float>{x, 0, random() % 20 != 0}; };
    for (auto left = random() % 300; left > 0; --left) {
      if (random() % 4 == 0) x += 1e-6F * static_cast<float>(random() % 3) - 1e-6F;
      controller.update(reading());
    }
    controller.update({std::numeric_limits<float>::quiet_NaN()});
    controller.reset();
    AxisController<float> other{braked_axis(), no_k3, kicks};
    other.reset();
    for (int i = 0; i < 200; ++i) {
      const auto next = reading();
      const auto expected = other.update(next), given = controller.update(next);
      ASSERT_EQ(given.force_N, expected.force_N) << trial << ", " << i;
      ASSERT_EQ(given.mode, expected.mode) << trial << ", " << i;
    }
  }
}

TEST(KickCycle, NeverExceedsTheForceLimitWhateverTheTableHolds) {
  std::mt19937_64 random{7};
  auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  for (int run = 0; run < 300; ++run) {
    for (auto& entry : kicks.table.entries) entry.a0 = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    kicks.table.count = static_cast<std::uint8_t>(random());
    kicks.table.list = run % 2 == 0;
    AxisController<float> controller{braked_axis(), no_k3, kicks};
    controller.limit_force(30);
    for (int i = 0; i < 60; ++i) ASSERT_LE(std::fabs(controller.update({-3e-5F}).force_N), 30);
    ASSERT_GT(controller.kicks(), 0U);
  }
}

// A counter-example of the campaign: friction that turns the motion within a period, where no plan of the approach
// holds, drove the axis to and fro for ever.
TEST(KickCycle, EndsAnApproachThatWouldGoToAndFroForEver) {
  design::BrakedClass c;
  c.mass_kg = {7.8719652197659951, 8.1585608062625443};
  c.friction = {92.222485716944036, 92.314800517461492};
  c.max_force_N = 642.6626418251102;
  c.force_step_N = 12.853252836502204;
  c.period_s = 4e-3;
  c.encoder_resolution_m = 1.6856380068193877e-06;
  c.latency_periods = 0;
  auto p = braked_axis();
  p.mass_kg = 8.0152630130142697F;
  p.friction = {static_cast<float>(c.friction.lower_N), static_cast<float>(c.friction.upper_N)};
  p.max_force_N = static_cast<float>(c.max_force_N);
  p.max_approach_speed_m_s = 10;
  p.period_s = 4e-3F;
  p.encoder_resolution_m = static_cast<float>(c.encoder_resolution_m);
  p.latency_periods = 0;
  p.position_tolerance_m = 2.0826236227089261e-05F;
  const auto kicks = design::design_braked_kicks<float>(c).kicks;
  TrueAxis truth;
  truth.mass_kg = c.mass_kg.least;
  truth.latency_periods = 0;
  const auto friction = [&](const Moment& now) {
    return c.friction.lower_N +
           (c.friction.upper_N - c.friction.lower_N) * std::exp(-std::fabs(now.velocity_m_s) / 0.02);
  };
  const auto end = run_kicked_axis<float>(p, no_k3, kicks, truth, friction, -0.0039431785267785621, 0, 4, 4, 50,
                                          -0.021673856949523729);
  EXPECT_TRUE(end.held) << end.error_m;
}

TEST(KickCycle, ScalesExactlyWithForceAndMass) {
  const auto force_of = [](float scale) {
    design::BrakedClass c = axes_of_the_scenes(1e-3);
    c.mass_kg = {scale, scale};
    c.friction = {2.5 * scale, 4.5 * scale};
    c.max_force_N *= scale;
    c.force_step_N *= scale;
    auto p = braked_axis();
    p.mass_kg = scale;
    p.friction = {2.5F * scale, 4.5F * scale};
    p.max_force_N *= scale;
    const auto kicks = design::design_braked_kicks<float>(c).kicks;
    AxisController<float> controller{p, no_k3, kicks};
    std::vector<float> forces;
    forces.reserve(300);
    for (int i = 0; i < 300; ++i)
      forces.push_back(controller.update({i < 100 ? -1e-2F + 5e-5F * float(i) : -5e-3F}).force_N);
    return forces;
  };
  const auto reference = force_of(1), scaled = force_of(16);
  for (std::size_t i = 0; i < reference.size(); ++i) ASSERT_EQ(16 * reference[i], scaled[i]) << i;
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

TEST(KickTable, WithoutACurveHasNoLeastDistance) {
  KickTable<float> table;
  EXPECT_EQ(table.least_m(), 0);
  EXPECT_EQ(table.reach_m(), 0);
  table = design::design_braked_kicks<float>(axes_of_the_scenes(0)).kicks.table;
  EXPECT_GT(table.least_m(), 0);
  table.count = 1;
  EXPECT_GT(table.least_m(), 0);
  table.list = true;
  EXPECT_EQ(table.least_m(), 0);
}

}  // namespace
}  // namespace breakaway::law
