// What a load on a spring demands of the law for one rigid mass.
#include "breakaway/design/spring_load.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "../../two_mass_axis.hpp"
#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/firmware/motion_under_force.hpp"

namespace breakaway::design {
namespace {

using breakaway::testing::axes_of_the_scenes;
using breakaway::testing::Moment;
using breakaway::testing::TwoMassAxis;

BrakedClass sprung_axes(double stiffness_N_per_m, bool encoder_on_load = false) {
  BrakedClass c = axes_of_the_scenes(0);
  c.spring_load = SpringLoad{0.4, 0.6, stiffness_N_per_m, {1.3, 2.4}, {1.2, 2.1}, encoder_on_load};
  return c;
}

TEST(SpringLoad, ResonatesAsTwoMassesOnASpring) {
  const SpringLoad load{0.5, 0.5, 1e6, {1, 2}, {1, 2}, false};
  EXPECT_NEAR(load.resonance_Hz(), std::sqrt(4e6) / (2 * std::numbers::pi), 1e-9);
  EXPECT_DOUBLE_EQ(load.unseen_m(0), 2e-6);
  const SpringLoad held_by_the_motor{0.5, 0.5, 1e6, {1, 2}, {1, 4}, false};
  EXPECT_DOUBLE_EQ(held_by_the_motor.unseen_m(0.5), 2.5e-6);
}

double safe_from_Hz(const BrakedClass& c, double tolerance_m) {
  BrakedClass whole = c;
  whole.spring_load.reset();
  return spring_demand(c, design_braked_kicks<float>(whole)).safe_from_Hz(c, tolerance_m);
}

TEST(SpringLoad, AsksForMoreThanASwingAPeriod) {
  const BrakedClass c = sprung_axes(1e6);
  EXPECT_DOUBLE_EQ(safe_from_Hz(c, 1), 1200);
  BrakedClass jittery = c;
  jittery.jitter_s = 2.5e-4;
  EXPECT_DOUBLE_EQ(safe_from_Hz(jittery, 1), 1600);
}

TEST(SpringLoad, IsSafeFromTheResonanceThatIsAskedFor) {
  for (const bool encoder_on_load : {false, true}) {
    for (const double tolerance_m : {1e-5, 1e-6}) {
      BrakedClass c = sprung_axes(1e6, encoder_on_load);
      const double ratio = safe_from_Hz(c, tolerance_m) / c.spring_load->resonance_Hz();
      c.spring_load->stiffness_N_per_m *= ratio * ratio;
      EXPECT_LE(sprung_m(c, 2.25, c.max_force_N, 1), tolerance_m * (1 + 1e-9));
      EXPECT_GE(c.spring_load->resonance_Hz(), 1200 * (1 - 1e-9));
    }
  }
}

TEST(SpringLoad, ProvesRestLongerByTheSwingOfTheMassOutOfSight) {
  const auto still = [](const BrakedClass& c) { return design_braked_kicks<float>(c).kicks.still_periods; };
  const int rigid = still(axes_of_the_scenes(0)), soft = still(sprung_axes(1e4));
  // The load of 0.6 kg swings half as long as pi sqrt(m2 / K), and once more while the motor's friction may drive it.
  EXPECT_GE(soft - rigid, std::floor(2e3 * std::numbers::pi * std::sqrt(0.6 / 1e4)));
}

TEST(SpringLoad, AddsNothingWhereThereIsNone) {
  EXPECT_EQ(sprung_m(axes_of_the_scenes(0), 2.25, 50, 1), 0);
  EXPECT_GT(sprung_m(sprung_axes(1e6), 2.25, 50, 1), 0);
  EXPECT_EQ(sprung_rest_s(axes_of_the_scenes(0), 2.25), 0);
}

// A drive that pushed the other way, or rested, until the swings were of any phase, pushes as hard as it may or hardly
// harder than friction: the watch of the node never takes the side that is read for one that is held.
TEST(SpringLoad, TakesUpNoMoreMotionThanIsStatedHoweverItSwings) {
  std::mt19937_64 bits{1};
  const auto between = [&](double low, double high) { return std::uniform_real_distribution{low, high}(bits); };
  for (int run = 0; run < 600; ++run) {
    BrakedClass c = axes_of_the_scenes(0);
    c.mass_kg = {0.85, 1.15}, c.force_gain = {0.85, 1.15};
    const double motor_kg = between(0.05, 0.95), B1 = between(0.3, 4.2), B2 = 4.5 - B1;
    c.spring_load =
        SpringLoad{motor_kg, 1 - motor_kg, std::pow(10, between(2, 5)), {B1 / 2, B1}, {B2 / 2, B2}, run % 2 == 1};
    c.spring_load->gap_m = run % 3 == 0 ? between(0, 1e-3) : 0;
    const double heavier = run % 5 == 0 ? 1.15 : between(0.85, 1.15), gain = run % 5 == 0 ? 0.85 : between(0.85, 1.15);
    SpringLoad truth = *c.spring_load;
    truth.motor_kg *= heavier, truth.load_kg *= heavier;
    const auto level = [](double N) { return [=](const Moment&) { return N; }; };
    TwoMassAxis axis{truth, between(0, 0.02), {.mass_kg = heavier, .force_gain = gain}, {level(B1), level(B2)}, 0};
    const double swing_s = 1 / truth.resonance_Hz(), period_s = swing_s / 200;
    const double breakaway_N = (B1 + B2) / c.force_gain.least;
    const double force_N = run % 4 < 2 ? c.max_force_N : breakaway_N * between(1.01, 2);
    const double before_s = swing_s * between(0, 3);
    for (double t = 0; t < before_s; t += period_s) axis.run(run % 7 == 0 ? 0 : -force_N, period_s, 1);
    firmware::MotionUnderForce<double> motion{1, breakaway_N, 1e-9, lost_motion_m(c)};
    double seen_m = std::round(axis.position_m() / 1e-9);
    for (double t = 0; t < 6 * swing_s; t += period_s) {
      axis.run(force_N, period_s, 1);
      const double now_m = std::round(axis.position_m() / 1e-9);
      motion.sample(now_m - std::exchange(seen_m, now_m), axis.given_N(), period_s);
      ASSERT_FALSE(motion.missing()) << "run " << run << " after " << t / swing_s << " swings";
    }
  }
}

// Of an encoder that stands, full force tells within a swing and a half, where the masses are alike.
TEST(SpringLoad, HidesABrokenEncoderForLittleMoreThanASwing) {
  for (const bool encoder_on_load : {false, true}) {
    for (const double stiffness : {1e2, 1e4}) {
      const BrakedClass c = sprung_axes(stiffness, encoder_on_load);
      firmware::MotionUnderForce<double> motion{1, 4.5, 1e-9, lost_motion_m(c)};
      double time_s = 0;
      for (; !motion.missing() && time_s < 10; time_s += 1e-3) motion.sample(0, c.max_force_N, 1e-3);
      EXPECT_LE(time_s, std::max(0.011, 1.5 / c.spring_load->resonance_Hz())) << stiffness;
    }
  }
  EXPECT_EQ(lost_motion_m(axes_of_the_scenes(0)), 0);
}

// The side that the encoder does not see swings on, for half a swing and for what the friction of the other may drive.
TEST(SpringLoad, WaitsForTheMotorWhereTheLoadIsRead) {
  const BrakedClass c = sprung_axes(1e4, true);
  const double by_chance_s = 8 * c.period_s;
  const double half_swing_s = std::numbers::pi * std::sqrt(0.4 / 1e4);
  // The friction of the load and the brake of 2.25 N are 4.35 N at most, 3.3 times what the motor's takes at least.
  EXPECT_NEAR(sprung_rest_s(c, 2.25), 3 * half_swing_s + by_chance_s, 1e-12);
  EXPECT_NEAR(sprung_rest_s(sprung_axes(1e4), 2.25), 3 * std::numbers::pi * std::sqrt(0.6 / 1e4) + by_chance_s, 1e-12);
  BrakedClass swings_for_ever = c;
  swings_for_ever.load_N = 1.3;  // all of the motor's least friction
  EXPECT_TRUE(std::isinf(sprung_rest_s(swings_for_ever, 2.25)));
}

// One pulse and the brake, under the least friction of either side: no spring and no split of the masses goes further
// than the rigid axis and what the spring adds.
TEST(SpringLoad, AddsAtMostWhatIsStatedToAKick) {
  for (const double stiffness : {1e5, 1e6, 1e7, 1e8}) {
    for (const double force_N : {5.0, 12.0, 50.0}) {
      const BrakedClass c = sprung_axes(stiffness);
      constexpr double brake_N = 2.25, period_s = 1e-3;
      const auto least = [](double level_N) { return [=](const Moment&) { return level_N; }; };
      TwoMassAxis axis{*c.spring_load, 0, {}, {least(1.3), least(1.2)}, 0};
      axis.run(force_N, period_s, 1);
      double furthest_m = 0;
      for (int i = 0; i < 200; ++i) {
        axis.run(-brake_N, period_s, 1);
        furthest_m = std::max(furthest_m, axis.position_m());
      }
      const double rigid_m = period_s * period_s * (force_N - 2.5) * (force_N + brake_N) / (2 * (2.5 + brake_N));
      EXPECT_GT(furthest_m, 0.2 * rigid_m);
      EXPECT_LE(furthest_m, rigid_m + sprung_m(c, brake_N, force_N, 1)) << stiffness << " N/m, " << force_N << " N";
    }
  }
}

}  // namespace
}  // namespace breakaway::design
