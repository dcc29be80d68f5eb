#include "breakaway/hal/bit_timing.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

namespace {

using breakaway::hal::bit_timing;
using breakaway::hal::BitTiming;

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

// The best of every timing that the controller can hold, tried one by one; of two that sample alike the one with more
// quanta.
std::optional<BitTiming> best_of_all(std::uint32_t clock_Hz, std::uint32_t bit_rate, std::uint32_t largest_prescaler) {
  std::optional<BitTiming> best;
  std::int64_t best_miss = 0;  // |sample point - 7/8| times 8 quanta
  for (std::uint32_t segment1 = 1; segment1 <= 16; ++segment1) {
    for (std::uint32_t segment2 = 1; segment2 <= 8; ++segment2) {
      const std::uint32_t quanta = 1 + segment1 + segment2, rate = quanta * bit_rate;
      if (quanta < 8 || clock_Hz % rate != 0) continue;
      const BitTiming t{clock_Hz / rate, segment1, segment2};
      if (t.prescaler < 1 || t.prescaler > largest_prescaler) continue;
      const std::int64_t miss = std::abs(8 * std::int64_t{1 + segment1} - 7 * std::int64_t{quanta});
      if (40 * miss > 8 * std::int64_t{quanta}) continue;  // outside of 85 to 90 %
      const std::int64_t difference = best ? miss * best->quanta() - best_miss * quanta : -1;
      if (difference > 0 || (difference == 0 && best->quanta() >= quanta)) continue;
      best = t;
      best_miss = miss;
    }
  }
  return best;
}

TEST(BitTiming, IsTheBestOfAllThatThereAre) {
  EXPECT_EQ(BitTiming{}.quanta(), 3U);
  EXPECT_EQ(BitTiming{}.prescaler, 1U);
  int found = 0;
  for (std::uint32_t quarters_MHz = 4; quarters_MHz <= 400; ++quarters_MHz) {
    for (const std::uint32_t bit_rate : {1'000'000U, 800'000U, 500'000U, 250'000U, 125'000U, 50'000U, 10'000U}) {
      for (const std::uint32_t largest_prescaler : {1U, 2U, 3U, 32U, 1024U}) {
        const std::uint32_t clock_Hz = quarters_MHz * 250'000;
        const auto expected = best_of_all(clock_Hz, bit_rate, largest_prescaler);
        const auto timing = bit_timing(clock_Hz, bit_rate, largest_prescaler);
        ASSERT_EQ(timing.has_value(), expected.has_value()) << clock_Hz << ' ' << bit_rate << ' ' << largest_prescaler;
        if (!timing) continue;
        ++found;
        ASSERT_EQ(timing->prescaler, expected->prescaler) << clock_Hz << ' ' << bit_rate << ' ' << largest_prescaler;
        ASSERT_EQ(timing->segment1, expected->segment1) << clock_Hz << ' ' << bit_rate << ' ' << largest_prescaler;
        ASSERT_EQ(timing->segment2, expected->segment2) << clock_Hz << ' ' << bit_rate << ' ' << largest_prescaler;
      }
    }
  }
  EXPECT_GT(found, 1000);
}

TEST(BitTiming, SaysWhenNoDivisorMakesTheRate) {
  EXPECT_FALSE(bit_timing(42'000'000, 0, 1024).has_value());
  EXPECT_FALSE(bit_timing(42'000'000, 999'999, 1024).has_value());
  EXPECT_FALSE(bit_timing(1'000'000, 1'000'000, 1024).has_value());
}

}  // namespace
