#include "breakaway/format/length_text.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace breakaway::format {
namespace {

TEST(LengthText, TakesTheUnitInWhichTheNumberIsShort) {
  EXPECT_EQ(length_text(5e-7), "500 nm");
  EXPECT_EQ(length_text(1.41317e-6), "1.413 µm");
  EXPECT_EQ(length_text(-0.000918784), "-918.8 µm");
  EXPECT_EQ(length_text(0.0123), "12.3 mm");
  EXPECT_EQ(length_text(4), "4 m");
}

TEST(LengthText, WritesNothingAsNothing) {
  EXPECT_EQ(length_text(0), "0 m");
  EXPECT_EQ(length_text(std::nan("")), "–");
}

}  // namespace
}  // namespace breakaway::format
