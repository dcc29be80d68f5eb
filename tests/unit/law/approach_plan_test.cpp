// The plan of an approach in periods without a reading, behind a lag, and where noise is all that is read.
#include "breakaway/law/approach_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../kicked_axis.hpp"
#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;

constexpr double sampling_s = 1e-3, away_m = -1;

BrakedApproach<double> approach_behind(double lag_s) {
  return design::design_braked_kicks<double>(axes_of_the_scenes(lag_s)).kicks.approach;
}

// The axis of the scenes under its least friction, which moves towards its target.
struct Mover {
  double x_m = away_m, v_m_s = 0;

  void run(double force_N) {
    const double gain_m_s = (force_N - 2.5) * sampling_s;
    x_m += (v_m_s + gain_m_s / 2) * sampling_s;
    v_m_s += gain_m_s;
  }
};

// Whether it plans a period without a reading.
bool reckons_on(ApproachPlan<double>& plan, double force_N) {
  EXPECT_FALSE(plan.see(std::nan(""), force_N, force_N, Reading::lost)) << "only a reading shows that";
  return plan.reckons();
}

TEST(ApproachPlan, KeepsToItsSpeedInPeriodsWithoutAReading) {
  const BrakedApproach<double> approach = approach_behind(0);
  for (const int seen_of : {2, 3, 5}) {
    ApproachPlan<double> plan{approach, sampling_s, 1, 0};
    Mover axis;
    double force_N = 0, fastest_m_s = 0;
    for (int n = 0; axis.x_m < -0.3; ++n) {
      ASSERT_LT(n, 2000);
      const bool seen = n % seen_of == 0;
      ASSERT_FALSE(plan.see(axis.x_m, force_N, force_N, seen ? Reading::there : Reading::lost));
      if (seen || plan.reckons()) force_N = std::clamp(plan.force_N(), -50.0, 50.0);
      axis.run(force_N);
      fastest_m_s = std::max(fastest_m_s, axis.v_m_s);
    }
    EXPECT_NEAR(fastest_m_s, 1, 1e-9) << "a period of the greatest force would add 0.0475 m/s";
  }
}

TEST(ApproachPlan, BrakesInTimeInPeriodsWithoutAReading) {
  const BrakedApproach<double> approach = approach_behind(0);
  ApproachPlan<double> plan{approach, sampling_s, 100, 0}, seeing{approach, sampling_s, 100, 0};
  Mover axis, seen;
  double force_N = 0, seen_force_N = 0;
  // Until the one that sees every period begins to brake, the other sees every period as well.
  while (seen_force_N >= 0) {
    ASSERT_FALSE(seeing.see(seen.x_m, seen_force_N, seen_force_N));
    seen_force_N = std::clamp(seeing.force_N(), -50.0, 50.0);
    if (seen_force_N >= 0) {
      ASSERT_FALSE(plan.see(axis.x_m, force_N, force_N));
      force_N = std::clamp(plan.force_N(), -50.0, 50.0);
      axis.run(force_N);
      seen.run(seen_force_N);
    }
  }
  ASSERT_TRUE(reckons_on(plan, force_N));
  EXPECT_NEAR(std::clamp(plan.force_N(), -50.0, 50.0), seen_force_N, 1e-6);
}

TEST(ApproachPlan, PlansNoForceWhereOnlyAReadingTellsWhatIsToBeDone) {
  const BrakedApproach<double> approach = approach_behind(0);
  ApproachPlan<double> plan{approach, sampling_s, 1, 0};
  EXPECT_FALSE(reckons_on(plan, 0)) << "before the first";
  EXPECT_FALSE(plan.see(away_m, 0, 0));
  EXPECT_TRUE(reckons_on(plan, 0));
  EXPECT_FALSE(plan.see(-approach.short_of_target_m - 1.01 * approach.switch_distance_m, 0, 0));
  bool goes_on = true;
  for (int n = 0; goes_on && n < 1000; ++n) goes_on = reckons_on(plan, 10);
  EXPECT_FALSE(goes_on) << "of an axis that is reckoned to have arrived";
}

// The target goes back to where the axis must brake at once, before it or behind it.
TEST(ApproachPlan, PlansForANewTargetInAPeriodWithoutAReading) {
  BrakedApproach<double> approach = approach_behind(0);
  approach.move = {1, 20, 20, 0};
  for (const double left_m : {0.001, -0.05}) {
    ApproachPlan<double> seeing{approach, sampling_s, 1, 0}, plan{approach, sampling_s, 1, 0};
    Mover axis;
    double force_N = 0;
    while (axis.v_m_s < 0.5) {
      for (ApproachPlan<double>* one : {&seeing, &plan}) {
        ASSERT_FALSE(one->see(axis.x_m, force_N, force_N));
        force_N = one->force_N();
      }
      axis.run(force_N);
    }
    const double shift_m = axis.x_m + left_m;
    seeing.retarget(shift_m);
    plan.retarget(shift_m);
    ASSERT_FALSE(seeing.see(axis.x_m - shift_m, force_N, force_N));
    ASSERT_TRUE(reckons_on(plan, force_N));
    const double seen_N = seeing.force_N();
    EXPECT_LT(seen_N, 0);
    EXPECT_NEAR(plan.force_N(), seen_N, 1e-6);
  }
}

TEST(ApproachPlan, IsNotThereByAForceThatIsYetToCome) {
  BrakedApproach<double> approach = approach_behind(1e-3);
  approach.lag_s = 4 * sampling_s;
  const double there_m = -approach.short_of_target_m - approach.switch_distance_m;
  ApproachPlan<double> plan{approach, sampling_s, 1, 0}, near{approach, sampling_s, 1, 0};
  // A command that leads 3 % of the way nearer once its force has come, and adds hardly any speed.
  const double command_N = -0.03 * there_m * approach.mass_kg / (approach.lag_s * approach.lag_s);
  ASSERT_FALSE(plan.see(1.02 * there_m, 0, 0));
  EXPECT_FALSE(plan.see(1.02 * there_m, 0, command_N));
  EXPECT_TRUE(near.see(0.98 * there_m, 0, 0));
}

// The first readings after an axis has set out are those of an axis at rest, and noise may say that it comes back.
TEST(ApproachPlan, CountsFrictionAgainstTheForceWhereNoiseIsAllThatIsRead) {
  BrakedApproach<double> approach = approach_behind(0);
  approach.standing_m_s = 0.01;
  constexpr int latency = 3;
  ApproachPlan<double> quiet{approach, sampling_s, 0.1, latency}, noisy{approach, sampling_s, 0.1, latency};
  double quiet_N = 0, noisy_N = 0;
  for (int n = 0; n < latency; ++n) {
    const double noise_m = n % 2 == 0 ? 0 : -1e-6 / approach.correction;
    ASSERT_FALSE(quiet.see(away_m, quiet_N, quiet_N));
    ASSERT_FALSE(noisy.see(away_m + noise_m, noisy_N, noisy_N));
    quiet_N = quiet.force_N();
    noisy_N = noisy.force_N();
  }
  // A speed that is off by 1 mm/s asks for 1 N within a period, and friction on the other side would for twice 2.5 N.
  EXPECT_NEAR(noisy_N, quiet_N, 2);
}

// An approach that begins under the brake is over with its first reading where its target moved by little, and what its
// current loop owes differs from nothing by its rounding: a brake along the motion would let the axis go further.
TEST(ApproachPlan, HeadsForItsTargetWhereRoundingIsAllThatIsKnownOfItsSpeed) {
  const BrakedApproach<double> approach = approach_behind(5e-3);
  const double near_m = 0.9 * (approach.short_of_target_m + approach.switch_distance_m), braked_N = -2;
  for (const double side : {-1.0, 1.0}) {
    ApproachPlan<double> plan{approach, sampling_s, 1, 0};
    ASSERT_TRUE(plan.see(side * near_m, side * -braked_N, side * -braked_N * (1 - 1e-15)));
    EXPECT_EQ(plan.heading(), -side);
    ASSERT_TRUE(plan.see(side * near_m, side * -braked_N * (1 - 1e-15), side * -braked_N));
    EXPECT_EQ(plan.heading(), -side);
  }
}

// What follows an approach whose target moved is no slow one: it may have passed the target only.
TEST(ApproachPlan, BeginsInMotionWhereItsTargetMovesOnTheWay) {
  const BrakedApproach<double> approach = approach_behind(0);
  ApproachPlan<double> plan{approach, sampling_s, 1, 0};
  plan.retarget(0.1);
  EXPECT_FALSE(plan.began_in_motion()) << "it had not set out";
  EXPECT_FALSE(plan.see(away_m, 0, 0));
  plan.retarget(0.1);
  EXPECT_TRUE(plan.began_in_motion());
  plan.restart();
  EXPECT_FALSE(plan.began_in_motion());
}

}  // namespace
}  // namespace breakaway::law
