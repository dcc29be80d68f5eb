// The law under the coast "brake" as a whole: what it is alike in, what it keeps to and what it tells.
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

TEST(BrakedAxis, ApproachesFromBothSidesAlike) {
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

// A force of 10 N brakes far less than the 50 N that the plan was made for.
TEST(BrakedAxis, BrakesAnApproachNoHarderThanALoweredLimitLetsIt) {
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

TEST(BrakedAxis, TellsTheSpeedWhenTheApproachIsOver) {
  Scripted axis{0};
  axis.pulse_at(-1e-4F);
  axis.show(-9e-5F);
  EXPECT_NEAR(axis.controller().velocity_m_s(), 0.01F, 1e-6F);
  axis.show(-9e-5F);
  EXPECT_EQ(axis.controller().velocity_m_s(), 0);
}

TEST(BrakedAxis, TellsAsWhatIsSureToMoveTheAxisTheGreatestFrictionAndForceBesideItByTheWeakestDrive) {
  design::BrakedClass c = axes_of_the_scenes(0);
  c.load_N = 0.5;
  c.force_gain = {0.9, 1.1};
  const auto kicks = design::design_braked_kicks<float>(c).kicks;
  const AxisController<float> controller{braked_axis(), no_k3, kicks};
  EXPECT_FLOAT_EQ(controller.breakaway_N(), 5 / 0.9F);
  EXPECT_EQ(controller.lost_motion_m(), 0);
}

// What acts on the axis is the same, so the law must be, too.
TEST(BrakedAxis, IsTheSameBesideAFeedforward) {
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
TEST(BrakedAxis, TakesALimitOfNothingTwice) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(1e-3)).kicks;
  auto weighed = braked_axis();
  weighed.feedforward_N = -8;
  AxisController<float> controller{weighed, no_k3, kicks};
  for (int i = 0; i < 3; ++i) controller.limit_force(5);
  for (int i = 0; i < 200; ++i) ASSERT_EQ(controller.update({-0.1F}).force_N, -8) << i;
  EXPECT_EQ(controller.fault(), ControlFault::none);
}

TEST(BrakedAxis, LatchesAFaultWhenTheSpeedOfTheApproachOverflows) {
  Scripted axis{1e-3};
  axis.show(0.01F);
  EXPECT_EQ(axis.show(3e38F).force_N, 0);
  EXPECT_EQ(axis.controller().fault(), ControlFault::not_a_number);
  axis.controller().reset();
  axis.show(0.01F);
  EXPECT_EQ(axis.show(0.01F).mode, Mode::approach) << "nothing of the overflow is left";
  EXPECT_EQ(axis.controller().velocity_m_s(), 0);
}

TEST(BrakedAxis, DoesAfterAResetTheSameWhateverItDidBefore) {
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

TEST(BrakedAxis, NeverExceedsTheForceLimitWhateverTheTableHolds) {
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
TEST(BrakedAxis, EndsAnApproachThatWouldGoToAndFroForEver) {
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

TEST(BrakedAxis, IsTheSameFromBothSides) {
  const auto kicks = design::design_braked_kicks<float>(axes_of_the_scenes(2e-3)).kicks;
  AxisController<float> left{braked_axis(), no_k3, kicks}, right{braked_axis(), no_k3, kicks};
  std::mt19937_64 random{23};
  int kicked = 0;
  float x = -3e-4F;
  for (int i = 0; i < 20'000; ++i) {
    if (left.fault() != ControlFault::none) left.reset(), right.reset();
    // Where a kick may have led it, and still else.
    if (left.mode() != Mode::hold && random() % 8 == 0) x += 1e-6F * static_cast<float>(random() % 9);
    if (random() % 300 == 0) x = 1e-6F * static_cast<float>(random() % 800) - 4e-4F;
    const bool fresh = random() % 50 != 0;
    const auto out = left.update({x, 0, fresh}), mirrored = right.update({-x, 0, fresh});
    // A force half-way between two steps of the drive is rounded up.
    ASSERT_NEAR(out.force_N, -mirrored.force_N, kicks.force_step_N * 1.001F) << i;
    ASSERT_EQ(out.mode, mirrored.mode) << i;
    kicked += out.kicked ? 1 : 0;
  }
  EXPECT_GT(kicked, 100);
}

TEST(BrakedAxis, ScalesExactlyWithForceAndMass) {
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

}  // namespace
}  // namespace breakaway::law
