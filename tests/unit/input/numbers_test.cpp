#include "breakaway/input/numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace breakaway {
namespace {

TEST(Numbers, AreRoundedToTheSideThatIsAskedForByLessThanADigit) {
  std::mt19937_64 dice{7};
  for (int i = 0; i < 2000; ++i) {
    const double value = std::pow(10, std::uniform_real_distribution<>{-12, 12}(dice));
    const int digits = 2 + i % 5;
    const double up = rounded_up(value, digits), down = rounded_down(value, digits);
    // Within the slack that keeps a value of no more digits.
    EXPECT_GE(up, value * (1 - 1e-8)) << value;
    EXPECT_LE(down, value * (1 + 1e-8)) << value;
    EXPECT_LE(up - down, value * std::pow(10, 1 - digits) * (1 + 1e-6)) << value;
    EXPECT_EQ(rounded_up(up, digits), up);
    EXPECT_EQ(rounded_down(down, digits), down);
  }
}

TEST(Numbers, ThatSomethingIsAtMostAreNotWrittenSmaller) {
  EXPECT_EQ(brief_up(2.8013341e-06), "2.80134e-06");
  EXPECT_EQ(brief_up(2.5e-06), "2.5e-06");
  EXPECT_EQ(brief_up(0), "0");
  EXPECT_EQ(brief_up(std::numeric_limits<double>::infinity()), "inf");
}

}  // namespace
}  // namespace breakaway
