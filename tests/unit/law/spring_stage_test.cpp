// The end of a run on the spring that friction is before it slides.
#include "breakaway/law/spring_stage.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../bristled_axis.hpp"
#include "scripted_axis.hpp"

namespace breakaway::law {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::BristledSlider;
using breakaway::testing::Bristles;
using breakaway::testing::Moment;
using breakaway::testing::RunEnd;
using breakaway::testing::TrueAxis;
using testing::braked_axis;
using testing::no_k3;

constexpr float tolerance_m = 5e-6F;
constexpr FrictionSpring<float> spring{.reach_m = 50e-6F,
                                       .step_m = 0.1e-6F,
                                       .most_N = 2,
                                       .gain_N_per_m = 2000,
                                       .share = 0.2F,
                                       .longest_periods = 400,
                                       .ringing_periods = 30};

FrictionSpring<float> led_by_coarse_steps() {
  FrictionSpring<float> coarse = spring;
  coarse.step_m = 0.6e-6F;
  return coarse;
}

// The place of an axis that follows the force on a spring, from where it rests without one.
template <class Step>
float place_after(SpringStage<float>& stage, float unloaded_m, float stiffness_N_per_m, int periods, const Step& step) {
  float x = unloaded_m;
  stage.start(x);
  for (int i = 0; i < periods; ++i) {
    stage.see(x);
    step();
    x = unloaded_m + stage.force_N() / stiffness_N_per_m;
  }
  return x;
}

TEST(SpringStage, LeadsAnAxisToTheTargetAndKeepsTheForceThere) {
  SpringStage<float> stage{spring, 1e-6F, tolerance_m};
  const float x = place_after(stage, 15e-6F, 1e5F, 300, [] {});
  EXPECT_LE(std::abs(x), 0.6e-6F);
  EXPECT_TRUE(stage.waits());
  const float kept_N = stage.force_N();
  stage.see(x);
  EXPECT_EQ(stage.force_N(), kept_N);
}

TEST(SpringStage, StopsAtItsLimitWhereTheSpringIsTooStiff) {
  SpringStage<float> stage{spring, 1e-6F, tolerance_m};
  place_after(stage, -15e-6F, 1e6F, 300, [&] { EXPECT_LE(std::abs(stage.force_N()), spring.most_N); });
  EXPECT_EQ(stage.force_N(), spring.most_N);
  EXPECT_TRUE(stage.waits());
}

TEST(SpringStage, SaysOnceThatItBeginsToWait) {
  SpringStage<float> stage{spring, 1e-6F, tolerance_m};
  stage.start(15e-6F);
  int times = 0;
  for (int i = 0; i < 300; ++i) times += stage.see(15e-6F) ? 1 : 0;
  EXPECT_EQ(times, 1);
}

TEST(SpringStage, KeepsItsForceAfterItsLongestTimeAndIsOverdueWhenTheAxisHasRungOut) {
  SpringStage<float> stage{spring, 1e-6F, tolerance_m};
  stage.start(5e-6F);
  for (int i = 0; i < spring.longest_periods; ++i) stage.see(i / 20 % 2 == 0 ? 5e-6F : -5e-6F);
  const float kept_N = stage.force_N();
  for (int i = 0; i < spring.ringing_periods; ++i) {
    EXPECT_FALSE(stage.overdue());
    stage.see(i / 20 % 2 == 0 ? 5e-6F : -5e-6F);
    EXPECT_EQ(stage.force_N(), kept_N);
    EXPECT_TRUE(stage.waits());
  }
  EXPECT_TRUE(stage.overdue());
}

TEST(SpringStage, LeadsAnAxisOnThatIsHeldHoweverLong) {
  SpringStage<float> stage{spring, 1e-6F, tolerance_m};
  stage.start(0);
  for (int i = 0; i < 2 * spring.longest_periods; ++i) stage.watch(0);
  EXPECT_EQ(stage.force_N(), 0);
  for (int i = 0; i < 20; ++i) stage.watch(2e-6F);
  EXPECT_LT(stage.force_N(), 0);
  EXPECT_FALSE(stage.overdue());
}

TEST(SpringStage, ChangesNoForceNearEnoughNorInAHoldWhereAStepOfItWouldSetTheAxisRinging) {
  SpringStage<float> stage{led_by_coarse_steps(), 1e-6F, tolerance_m};
  stage.start(4e-6F);
  for (int i = 0; i < 50; ++i) stage.see(4e-6F);
  EXPECT_TRUE(stage.waits());
  for (int i = 0; i < 50; ++i) stage.watch(20e-6F);
  EXPECT_EQ(stage.force_N(), 0);
  for (int i = 0; i < 50; ++i) stage.see(20e-6F);
  EXPECT_LT(stage.force_N(), 0) << "which is further away than near enough";
}

TEST(SpringStage, OnlyWatchesAnAxisThatItDoesNotReach) {
  SpringStage<float> stage{spring, 1e-6F, 100e-6F};
  stage.start(60e-6F);
  for (int i = 0; i < 50; ++i) stage.see(60e-6F);
  EXPECT_EQ(stage.force_N(), 0);
  EXPECT_TRUE(stage.waits());
}

TEST(SpringStage, ReachesNowhereWithoutASpring) {
  const FrictionSpring<float> none = design::design_braked_kicks<float>(axes_of_the_scenes(1e-4)).kicks.spring;
  EXPECT_FALSE(none.is_there());
  EXPECT_FALSE((SpringStage<float>{none, 1e-6F, tolerance_m}.reaches(1e-9F)));
}

// Of an axis whose friction is a soft spring before it slides.
BrakedKicks<float> soft_kicks() {
  design::BrakedClass c = axes_of_the_scenes(0);
  c.presliding_stiffness_N_per_m = 1e5;
  return design::design_braked_kicks<float>(c).kicks;
}

// A ringing that never shows rest ends in a fault only where no spring would mend what is left.
TEST(SpringStage, TakesOverWithinItsReachAnAxisThatRingsForLongerThanItMay) {
  const auto kicks = soft_kicks();
  for (const bool within : {true, false}) {
    AxisController<float> controller{braked_axis(1.8e-6F), no_k3, kicks};
    const float from_m = -4 * kicks.spring.reach_m, at_m = within ? 0 : from_m / 2;
    int periods = 0;
    while (!controller.update({from_m}).kicked && ++periods < 10'000) continue;
    ControlOutput<float> out;
    const auto rings = [&] { return out.mode == Mode::fault || (out.mode == Mode::coast && out.force_N > 0); };
    for (periods = 0; !(periods > 10 && rings()) && periods < 10'000; ++periods)
      out = controller.update({at_m + (periods % 2 == 0 ? -8e-6F : 8e-6F)});
    EXPECT_LT(periods, 10'000) << within;
    EXPECT_EQ(controller.fault(), within ? ControlFault::none : ControlFault::drifting);
    EXPECT_EQ(controller.kicks(), 1U);
  }
}

// One that was held for longer than the stage may take is still in motion when it leaves its hold.
TEST(SpringStage, WaitsForAnAxisThatIsPushedToRestHoweverLongItWasHeld) {
  const auto kicks = soft_kicks();
  for (const int held : {1000, kicks.spring.longest_periods + 1000}) {
    AxisController<float> controller{braked_axis(1.8e-6F), no_k3, kicks};
    const int most = held + 2 * kicks.spring.ringing_periods;
    for (int i = 0, holds = 0; holds < held && i < most; ++i) {
      controller.update({0});
      if (controller.mode() == Mode::hold) ++holds;
    }
    ASSERT_EQ(controller.mode(), Mode::hold);
    constexpr int pushed = 8;
    int periods = 0;
    const auto reading_m = [&] { return 15e-6F * static_cast<float>(std::min(++periods, pushed)); };
    while (!controller.update({reading_m()}).kicked && periods < 1000) continue;
    EXPECT_GT(periods, pushed + kicks.either_way_periods) << "held for " << held;
    EXPECT_LT(periods, 1000);
  }
}

// Two readings a ring or fewer may all be the same.
TEST(SpringStage, HoldsAnAxisOnlyWhenRingingThatNoReadingShowsIsOver) {
  auto kicks = soft_kicks();
  kicks.spring.ringing_periods = 77;
  AxisController<float> controller{braked_axis(1.8e-6F), no_k3, kicks};
  int coasts = 0, periods = 0;
  for (; controller.mode() != Mode::hold && periods < 1000; ++periods) {
    controller.update({0.2e-6F});
    coasts += controller.mode() == Mode::coast ? 1 : 0;
  }
  EXPECT_LT(periods, 1000);
  EXPECT_GT(coasts, kicks.spring.ringing_periods / 2);
}

TEST(SpringStage, KicksAnAxisThatIsLedNoFurtherWithoutWaitingForThat) {
  auto kicks = soft_kicks();
  kicks.spring.ringing_periods = 10'000;
  AxisController<float> controller{braked_axis(1.8e-6F), no_k3, kicks};
  int periods = 0;
  while (!controller.update({15e-6F}).kicked && periods < 1000) ++periods;
  EXPECT_LT(periods, 1000);
}

// By the mean of its readings, which show it to and fro and so let it wait for the end of its ringing.
TEST(SpringStage, DoesNotKickAnAxisThatRestsBetweenAReadingWithinTheToleranceAndOneBeyond) {
  auto kicks = soft_kicks();
  kicks.spring.ringing_periods = 60;
  AxisController<float> controller{braked_axis(0.51e-6F), no_k3, kicks};
  bool kicked = false;
  for (int i = 0; i < 2000; ++i) kicked |= controller.update({i % 45 < 15 ? 0.645e-6F : -0.355e-6F}).kicked;
  EXPECT_FALSE(kicked);
  EXPECT_EQ(controller.mode(), Mode::coast);
  for (int i = 0; i < 100; ++i) controller.update({-0.355e-6F});
  EXPECT_EQ(controller.mode(), Mode::hold);
}

// told: share of the stiffness that the law is told.
RunEnd settle(const Bristles& bristles, double told, double friction_N, double start_m) {
  design::BrakedClass c = axes_of_the_scenes(0);
  c.presliding_stiffness_N_per_m = told * bristles.stiffness_N_per_m;
  auto p = testing::sampled_axis<float>();
  p.coast = Coast::brake;
  p.position_tolerance_m = 0.7e-6F;
  const auto kicks = design::design_braked_kicks<float>(c).kicks;
  const K3Table<float> unused;
  const auto friction = [=](const Moment&) { return friction_N; };
  return run_axis<float>(p, unused, kicks, BristledSlider{TrueAxis{}, bristles, friction, start_m, 0}, 1, 20);
}

TEST(SpringStage, EndsWithinACountOnBristlesOfEveryStiffness) {
  for (const double stiffness : {1e5, 1e6, 1e7}) {
    for (const double damping : {0.0, 2 * std::sqrt(stiffness)}) {
      for (const double told : {1.0, 0.33}) {
        const RunEnd end = settle({stiffness, damping}, told, 3.3, 1e-3);
        EXPECT_TRUE(end.held) << stiffness << ", " << damping << ", " << told << ": " << to_string(end.fault);
        EXPECT_LE(std::abs(end.error_m), 1.2e-6) << stiffness << ", " << damping << ", " << told;
      }
    }
  }
}

TEST(SpringStage, NeedsNoKickWhereTheSpringReaches) {
  const RunEnd end = settle({1e5, 600}, 1, 2.5, -20e-6);
  EXPECT_TRUE(end.held);
  EXPECT_EQ(end.kicks, 0) << "the spring reaches so far";
  EXPECT_LE(std::abs(end.error_m), 0.6e-6);
}

// Bristles that ring faster than readings show, behind a latency: the force followed them late, from one limit to the
// other for seconds, and the axis was held in motion.
TEST(SpringStage, LeadsAnAxisWhoseRingingReadingsDoNotShowWithoutSwinging) {
  design::BrakedClass c = axes_of_the_scenes(1.8e-3);
  c.period_s = 10e-3;
  c.encoder_resolution_m = 0.235e-6;
  c.presliding_stiffness_N_per_m = 5.8e5;
  c.friction = {3.45, 5.2};
  c.latency_periods = 3;
  const auto kicks = design::design_braked_kicks<float>(c).kicks;
  auto p = braked_axis(250e-6F);
  p.friction = {3.45F, 5.2F};
  p.period_s = 10e-3F;
  p.encoder_resolution_m = 0.235e-6F;
  p.latency_periods = 3;
  const TrueAxis truth{1, 1, 1.8e-3, 0, 3};
  const auto friction = [](const Moment&) { return 3.45; };
  const RunEnd end = run_axis<float>(p, no_k3, kicks, BristledSlider{truth, {5.8e5, 0, 0}, friction, 10e-6, 0}, 3, 60);
  EXPECT_TRUE(end.held);
  EXPECT_FALSE(end.moving_in_hold);
  EXPECT_EQ(end.kicks, 0);
  EXPECT_LE(end.time_s, 0.5 * kicks.spring.longest_periods * c.period_s);
}

}  // namespace
}  // namespace breakaway::law
