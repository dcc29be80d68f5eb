#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "breakaway/odrive/torque_grid.hpp"
#include "breakaway/odrive/turns_scale.hpp"

namespace breakaway::odrive {
namespace {

TEST(TurnsScale, CountsToTheNearestAsFarAsAFloatIsFineEnough) {
  const TurnsScale scale{1e5};
  EXPECT_EQ(scale.counts(1.0F), 100000);
  EXPECT_EQ(scale.counts(-2.5F), -250000);
  EXPECT_EQ(scale.counts(0.0F), 0);
  EXPECT_EQ(scale.counts(4.9e-6F), 0);
  EXPECT_EQ(scale.counts(5.1e-6F), 1);
}

// Between 64 and 128 turns floats are 2^-17 turns apart, 0.76 counts of 1e-5 turns; beyond, 1.5 counts.
TEST(TurnsScale, TakesNoPositionWhereAFloatIsCoarserThanACount) {
  const TurnsScale scale{1e5};
  EXPECT_TRUE(scale.counts(std::nextafter(128.0F, 0.0F)));
  EXPECT_FALSE(scale.counts(128.0F));
  EXPECT_FALSE(scale.counts(-128.0F));
  EXPECT_FALSE(scale.counts(1e30F));
}

// At 2^17 counts a turn that spacing is a count.
TEST(TurnsScale, TakesAPositionWhereAFloatIsAsCoarseAsACount) {
  const TurnsScale scale{131072};
  EXPECT_EQ(scale.counts(127.0F), 16646144);
  EXPECT_EQ(scale.counts(-127.0F), -16646144);
  EXPECT_FALSE(scale.counts(128.0F));
}

TEST(TurnsScale, TakesNothingThatIsNoNumber) {
  const TurnsScale scale{1e5};
  EXPECT_FALSE(scale.counts(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_FALSE(scale.counts(std::numeric_limits<float>::infinity()));
  EXPECT_FALSE(scale.counts(-std::numeric_limits<float>::infinity()));
}

TEST(TurnsScale, IsOffByHalfACountAndHalfASpacingAtMost) {
  const TurnsScale scale{1e5};
  std::mt19937 random{7};
  std::uniform_real_distribution<double> turns{-127.9, 127.9};
  for (int i = 0; i < 100000; ++i) {
    const double truth = turns(random);
    const auto counts = scale.counts(static_cast<float>(truth));
    ASSERT_TRUE(counts);
    EXPECT_LE(std::abs(*counts - truth * 1e5), 0.5 + float_spacing(truth) * 1e5 / 2 + 1e-9) << truth;
  }
}

TEST(TurnsScale, NeverLeaves32Bits) {
  const TurnsScale coarse{1e-3}, fine{2e7};
  EXPECT_EQ(coarse.counts(1e6F), 1000);
  EXPECT_EQ(coarse.counts(1e7F), 10000);
  EXPECT_FALSE(coarse.counts(-1e30F));
  EXPECT_FALSE(fine.counts(120.0F)) << "2.4e9 counts";
}

TEST(FloatSpacing, IsThatOfTheNeighbour) {
  EXPECT_EQ(float_spacing(1), 0x1p-23);
  EXPECT_EQ(float_spacing(-1), 0x1p-23);
  EXPECT_EQ(float_spacing(100), 0x1p-17);
  EXPECT_EQ(float_spacing(0.5), 0x1p-24);
  EXPECT_EQ(float_spacing(0), 0x1p-149);
}

TEST(TorqueGrid, NeverExceedsTheLimitForAnyForce) {
  std::mt19937 random{11};
  for (int i = 0; i < 200000; ++i) {
    std::uniform_real_distribution<float> size{-3, 3};
    const float max_torque_Nm = std::pow(10.0F, size(random)), lever = std::pow(10.0F, size(random));
    const float limit_N = max_torque_Nm * lever * std::pow(10.0F, size(random) / 3);
    const TorqueGrid<float> grid{max_torque_Nm, lever, limit_N};
    const float force_N = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    const float torque_Nm = grid.torque_Nm(force_N);
    ASSERT_TRUE(std::isfinite(torque_Nm));
    EXPECT_LE(std::abs(torque_Nm), max_torque_Nm * (1 + 1e-6F));
    EXPECT_LE(std::abs(torque_Nm) * lever, limit_N * (1 + 1e-6F));
    if (std::abs(force_N) <= grid.max_force_N()) {
      EXPECT_NEAR(torque_Nm * lever, force_N, grid.step_N() * 0.51F + std::abs(force_N) * 1e-5F);
    }
  }
}

// Rounded, such a limit over a step is a whole number of steps again.
TEST(TorqueGrid, NeverExceedsALimitThatIsAHairBelowAStep) {
  for (const float lever : {0.1F, 3.3F, 49.7F, 1234.5F}) {
    const float step_N = 1.0F / torque_steps * lever;
    for (int steps = 1; steps < torque_steps; ++steps) {
      const float limit_N = std::nextafter(static_cast<float>(steps) * step_N, 0.0F);
      const TorqueGrid<float> grid{1, lever, limit_N};
      ASSERT_LE(grid.max_force_N(), limit_N) << lever << ", " << steps;
      ASSERT_GE(grid.max_force_N(), limit_N - step_N * 1.001F) << lever << ", " << steps;
    }
  }
}

TEST(TorqueGrid, HasAllStepsOfALimitThatIsAWholeNumberOfThem) {
  const TorqueGrid<float> half{1, 32, 16}, all{1, 32, 1000}, one{1, 32, 32.0F / 16384};
  EXPECT_EQ(half.step_N(), 32.0F / 16384);
  EXPECT_EQ(half.max_force_N(), 16);
  EXPECT_EQ(half.torque_Nm(1e9F), 0.5F);
  EXPECT_EQ(half.torque_Nm(-1e9F), -0.5F);
  EXPECT_EQ(all.max_force_N(), 32) << "the motor has no more";
  EXPECT_EQ(all.torque_Nm(1e9F), 1);
  EXPECT_EQ(one.max_force_N(), one.step_N());
  EXPECT_EQ(one.torque_Nm(1), 1.0F / 16384);
  EXPECT_EQ(one.force_N(1.0F / 16384), one.step_N());
}

// A step that a float does not hold in full is not to be counted with.
TEST(TorqueGrid, GivesNothingWhereAStepIsTooSmallForAFloat) {
  for (const TorqueGrid<float>& grid : {TorqueGrid<float>{1e-36F, 1e10F, 1}, TorqueGrid<float>{1e-30F, 1e-8F, 1},
                                        TorqueGrid<float>{1e-36F, 1e-10F, 1}}) {
    EXPECT_EQ(grid.max_force_N(), 0);
    EXPECT_EQ(grid.torque_Nm(0), 0);
    EXPECT_EQ(grid.torque_Nm(1), 0);
  }
}

TEST(TorqueGrid, GivesNothingForWhatIsNoNumber) {
  const TorqueGrid<float> grid{1, 50, 50};
  EXPECT_EQ(grid.torque_Nm(std::numeric_limits<float>::quiet_NaN()), 0);
  EXPECT_EQ(grid.torque_Nm(std::numeric_limits<float>::infinity()), 0);
}

TEST(TorqueGrid, SaysWhenAStepIsMoreThanTheLimit) {
  const TorqueGrid<float> grid{1, 50, 50.0F / 16384 / 2};
  EXPECT_EQ(grid.max_force_N(), 0);
  EXPECT_EQ(grid.torque_Nm(1), 0);
}

TEST(TorqueGrid, TurnsAReportBackIntoForce) {
  const TorqueGrid<float> grid{0.8F, 50, 40};
  EXPECT_FLOAT_EQ(grid.force_N(0.4F), 20);
  EXPECT_FLOAT_EQ(grid.max_force_N(), 40);
}

}  // namespace
}  // namespace breakaway::odrive
