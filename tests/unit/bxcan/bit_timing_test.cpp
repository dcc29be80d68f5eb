#include "breakaway/bxcan/bit_timing.hpp"

#include <gtest/gtest.h>

namespace {

using breakaway::bxcan::bit_timing;

TEST(BxcanBitTiming, MakesEveryCanopenRateExactlyNearTheRecommendedSamplePoint) {
  for (const std::uint32_t clock_Hz : {42'000'000U, 36'000'000U, 16'000'000U}) {
    for (const std::uint32_t bit_rate :
         {1'000'000U, 800'000U, 500'000U, 250'000U, 125'000U, 50'000U, 20'000U, 10'000U}) {
      const auto t = bit_timing(clock_Hz, bit_rate);
      if (clock_Hz == 42'000'000 && bit_rate == 800'000) {
        EXPECT_FALSE(t.has_value()) << "52.5 clocks a bit";
        continue;
      }
      ASSERT_TRUE(t.has_value()) << clock_Hz << ' ' << bit_rate;
      EXPECT_EQ(clock_Hz, t->prescaler * t->quanta() * bit_rate);
      const double sample_point = double(1 + t->segment1) / t->quanta();
      EXPECT_NEAR(sample_point, 0.875, 0.0251) << "CiA 301 gives 85 to 90 %";
      EXPECT_LE(t->segment1, 16U);
      EXPECT_LE(t->segment2, 8U);
      EXPECT_LE(t->prescaler, 1024U);
    }
  }
}

TEST(BxcanBitTiming, WritesTheRegisterAsTheManualLaysItOut) {
  EXPECT_EQ((breakaway::bxcan::BitTiming{3, 11, 2}.register_value()), 0x001A0002U);
}

TEST(BxcanBitTiming, SaysWhenNoDivisorMakesTheRate) {
  EXPECT_FALSE(bit_timing(42'000'000, 0).has_value());
  EXPECT_FALSE(bit_timing(42'000'000, 999'999).has_value());
  EXPECT_FALSE(bit_timing(1'000'000, 1'000'000).has_value());
}

}  // namespace
