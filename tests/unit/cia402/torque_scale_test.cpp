#include "breakaway/cia402/torque_scale.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace {

using breakaway::cia402::TorqueBase;
using breakaway::cia402::TorqueScale;

template <class Scalar>
class TorqueScaleTest : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(TorqueScaleTest, Scalars);

TYPED_TEST(TorqueScaleTest, QuantumIsTheForceOfOnePerMille) {
  // 1.27 Nm rated, 200 N a Nm: 254 N at the rated torque.
  const TorqueScale<TypeParam> scale{1270, 3000, TypeParam{200}, TypeParam{500}};
  EXPECT_NEAR(static_cast<double>(scale.quantum_N()), 0.254, 1e-7);
  EXPECT_EQ(scale.limit_per_mille(), 1968);  // 500 / 0.254 = 1968.5: rounding up would exceed the limit
  EXPECT_EQ(scale.per_mille(TypeParam(0.254 * 100)), 100);
  EXPECT_EQ(scale.per_mille(TypeParam(0.254 * 100.6)), 101);
  EXPECT_EQ(scale.per_mille(TypeParam(-0.254 * 100.6)), -101);
}

TYPED_TEST(TorqueScaleTest, NeverBeyondTheAxisLimitNorTheDrives) {
  const TorqueScale<TypeParam> axis_limited{1000, 3000, TypeParam{50}, TypeParam{60}};
  EXPECT_EQ(axis_limited.per_mille(TypeParam{1e30F}), 1200);
  const TorqueScale<TypeParam> drive_limited{1000, 900, TypeParam{50}, TypeParam{60}};
  EXPECT_EQ(drive_limited.per_mille(TypeParam{-1e30F}), -900);
  EXPECT_NEAR(static_cast<double>(drive_limited.max_force_N()), 45.0, 1e-5);
  const TorqueScale<TypeParam> wide{1, 65535, TypeParam{1}, TypeParam{1e6F}};
  EXPECT_EQ(wide.per_mille(TypeParam{1e6F}), 32767) << "6071h is signed";
}

TYPED_TEST(TorqueScaleTest, LimitOfWholeQuantaIsReachedInEitherPrecision) {
  for (unsigned rated = 1; rated < 5000; ++rated) {
    const auto quantum = static_cast<TypeParam>(rated) * TypeParam{7} / TypeParam{1'000'000};
    const TorqueScale<TypeParam> scale{rated, 3000, TypeParam{7}, quantum * TypeParam{1000}};
    ASSERT_EQ(scale.limit_per_mille(), 1000) << rated;
    ASSERT_LE(scale.max_force_N(), quantum * TypeParam{1000});
  }
}

// 0.05 N a per mille of the rated torque, of which the largest is 3 times as much.
TYPED_TEST(TorqueScaleTest, ATargetMayCountInTheLargestTorqueAndTheActualOneCountsInTheRated) {
  const TorqueScale<TypeParam> scale{1000, 3000, TypeParam{50}, TypeParam{150}, TorqueBase::largest};
  EXPECT_EQ(scale.per_mille(TypeParam{75}), 500);
  EXPECT_EQ(scale.per_mille(TypeParam{-1e30F}), -1000);
  EXPECT_NEAR(static_cast<double>(scale.force_N(500)), 25.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(scale.max_force_N()), 150.0, 1e-4);
  const TorqueScale<TypeParam> lower{1000, 3000, TypeParam{50}, TypeParam{60}, TorqueBase::largest};
  EXPECT_EQ(lower.per_mille(TypeParam{1e30F}), 400) << "the axis' limit counts in either";
  const TorqueScale<TypeParam> wider{1000, 3000, TypeParam{50}, TypeParam{1000}, TorqueBase::largest};
  EXPECT_EQ(wider.per_mille(TypeParam{1e30F}), 1000) << "and so does the drive's";
}

TYPED_TEST(TorqueScaleTest, NotANumberAndInfinityAreNoForce) {
  using Limits = std::numeric_limits<TypeParam>;
  const TorqueScale<TypeParam> scale{1000, 3000, TypeParam{50}, TypeParam{60}};
  for (const TypeParam value : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity()})
    EXPECT_EQ(scale.per_mille(value), 0);
}

TYPED_TEST(TorqueScaleTest, UnknownRatingMeansNoForce) {
  EXPECT_EQ(TorqueScale<TypeParam>{}.per_mille(TypeParam{10}), 0);
  EXPECT_EQ((TorqueScale<TypeParam>{0, 1000, TypeParam{1}, TypeParam{1}}.per_mille(TypeParam{10})), 0);
}

// One newton a per mille: a limit that lacks more than rounding of a whole per mille has one less.
TEST(TorqueScale, ALimitJustBelowAWholePerMilleIsCutDown) {
  constexpr float ulp = 0x1p-14F;  // of floats just below 1000
  const TorqueScale<float> scale{1'000'000, 3000, 1.0F, 1000.0F - 9 * ulp};
  EXPECT_EQ(scale.limit_per_mille(), 999);
  EXPECT_EQ((TorqueScale<float>{1'000'000, 3000, 1.0F, 1000.0F - 2 * ulp}.limit_per_mille()), 1000);
}

TEST(TorqueScale, OnePerMilleIsALimitToo) {
  const TorqueScale<float> scale{1000, 1, 50.0F, 60.0F};
  EXPECT_EQ(scale.limit_per_mille(), 1);
  for (const float force_N : {60.0F, 0.05F}) {
    EXPECT_EQ(scale.per_mille(force_N), 1);
    EXPECT_EQ(scale.per_mille(-force_N), -1);
  }
}

TEST(TorqueScale, AnyBitPatternStaysInsideTheLimits) {
  std::mt19937_64 random{5};
  const TorqueScale<float> single{1270, 3000, 200.0F, 500.0F};
  const TorqueScale<double> precise{1270, 3000, 200.0, 500.0};
  for (int i = 0; i < 2'000'000; ++i) {
    const std::uint64_t bits = random();
    const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    ASSERT_LE(std::abs(single.per_mille(value)), 1968) << value;
    ASSERT_LE(std::abs(precise.per_mille(std::bit_cast<double>(bits))), 1968);
    // Half a quantum, and the two roundings of a float near 500 (3e-5 each).
    if (std::isfinite(value) && std::fabs(value) < 499.8F) {
      ASSERT_NEAR(static_cast<double>(single.force_N(single.per_mille(value))), static_cast<double>(value), 0.12706);
    }
  }
}

}  // namespace
