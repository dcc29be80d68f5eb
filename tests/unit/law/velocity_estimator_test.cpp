#include "breakaway/law/velocity_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace breakaway::law {
namespace {

constexpr double period_s = 1e-3;

TEST(VelocityEstimator, IsTheExactDifferenceWhenTheEncoderIsFine) {
  VelocityEstimator<double> v{period_s, 1e-6, 60.0, 2.5};
  EXPECT_EQ(v.weight(), 1.0);
  EXPECT_EQ(v.update(0.5), 0.0) << "one position says nothing about velocity";
  EXPECT_DOUBLE_EQ(v.update(0.502), 2.0);
  EXPECT_NEAR(v.update(0.501), -1.0, 1e-12);
}

TEST(VelocityEstimator, KeepsTheForceOfOneCountBelowFivePercentOfTheLeastFriction) {
  for (const double resolution_m : {1e-7, 1e-6, 1e-5, 1e-4, 1e-3}) {
    VelocityEstimator<double> v{period_s, resolution_m, 60.0, 2.5};
    v.update(0.0);
    EXPECT_LE(60.0 * v.update(resolution_m), 0.05 * 2.5 * (1 + 1e-12)) << resolution_m;
  }
}

TEST(VelocityEstimator, ConvergesToAConstantVelocity) {
  VelocityEstimator<double> v{period_s, 1e-5, 60.0, 2.5};
  ASSERT_LT(v.weight(), 1.0);
  double x = 0;
  for (int i = 0; i < 200; ++i) v.update(x += 3 * period_s);
  EXPECT_NEAR(v.velocity_m_s(), 3.0, 1e-9);
}

TEST(VelocityEstimator, CountsPeriodsWithoutASample) {
  VelocityEstimator<double> v{period_s, 1e-6, 60.0, 2.5};
  v.update(0.0);
  v.skip();
  v.skip();
  EXPECT_NEAR(v.update(6e-3), 2.0, 1e-12);
  EXPECT_NEAR(v.update(8e-3), 2.0, 1e-12) << "the next sample is one period away again";
}

TEST(VelocityEstimator, DoesNotSeeATargetChangeAsMotion) {
  VelocityEstimator<double> v{period_s, 1e-6, 60.0, 2.5};
  v.update(1.0);
  v.shift_origin(0.25);
  EXPECT_EQ(v.update(0.75), 0.0);
}

}  // namespace
}  // namespace breakaway::law
