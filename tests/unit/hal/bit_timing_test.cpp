#include "breakaway/hal/bit_timing.hpp"

#include <gtest/gtest.h>

namespace {

using breakaway::hal::bit_timing;

struct Controller {
  const char* name;
  std::uint32_t clock_Hz, largest_prescaler;
};

TEST(BitTiming, MakesEveryCanopenRateExactlyNearTheRecommendedSamplePoint) {
  for (const Controller& c : {Controller{"bxCAN", 42'000'000, 1024}, Controller{"bxCAN", 36'000'000, 1024},
                              Controller{"bxCAN", 16'000'000, 1024}, Controller{"ZynqMP", 100'000'000, 256}}) {
    for (const std::uint32_t bit_rate :
         {1'000'000U, 800'000U, 500'000U, 250'000U, 125'000U, 50'000U, 20'000U, 10'000U}) {
      const auto t = bit_timing(c.clock_Hz, bit_rate, c.largest_prescaler);
      if (c.clock_Hz == 42'000'000 && bit_rate == 800'000) {
        EXPECT_FALSE(t.has_value()) << "52.5 clocks a bit";
        continue;
      }
      if (c.clock_Hz == 100'000'000 && bit_rate == 800'000) {
        EXPECT_FALSE(t.has_value()) << "25 quanta would be sampled at 68 % at the latest";
        continue;
      }
      if (c.largest_prescaler == 256 && bit_rate == 10'000) {
        EXPECT_FALSE(t.has_value()) << "10000 clocks a bit are more than 25 x 256";
        continue;
      }
      ASSERT_TRUE(t.has_value()) << c.name << ' ' << c.clock_Hz << ' ' << bit_rate;
      EXPECT_EQ(c.clock_Hz, t->prescaler * t->quanta() * bit_rate);
      const double sample_point = double(1 + t->segment1) / t->quanta();
      EXPECT_NEAR(sample_point, 0.875, 0.0251) << "CiA 301 gives 85 to 90 %";
      EXPECT_LE(t->segment1, 16U);
      EXPECT_LE(t->segment2, 8U);
      EXPECT_LE(t->prescaler, c.largest_prescaler);
    }
  }
}

TEST(BitTiming, SaysWhenNoDivisorMakesTheRate) {
  EXPECT_FALSE(bit_timing(42'000'000, 0, 1024).has_value());
  EXPECT_FALSE(bit_timing(42'000'000, 999'999, 1024).has_value());
  EXPECT_FALSE(bit_timing(1'000'000, 1'000'000, 1024).has_value());
}

}  // namespace
