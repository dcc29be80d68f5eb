// What people are told, and the words and numbers in it.
#include "breakaway/input/input_error.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "../refusal.hpp"
#include "breakaway/input/edit_distance.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway {
namespace {

using testing::refusal;

TEST(InputErrorText, BeginsWithTheFileAndTheKeyWhereThereAreSuch) {
  const InputError error{"axis.mass_kg", "is 0;\ngive more"};
  EXPECT_STREQ(error.what(), "axis.mass_kg is 0; give more");
  EXPECT_STREQ(error.in_file("a.toml").what(), "a.toml: axis.mass_kg is 0; give more");
  EXPECT_STREQ(error.in_file("").what(), error.what());
  EXPECT_EQ(error.in_file("a.toml").file(), "a.toml");
  EXPECT_EQ(error.in_file("a.toml").key(), "axis.mass_kg");
  EXPECT_EQ(error.in_file("a.toml").problem(), "is 0; give more");
  EXPECT_STREQ(InputError{"nothing is there"}.what(), "nothing is there");
}

TEST(EditDistance, CountsLettersThatAreLeftOutAddedOrReplaced) {
  EXPECT_EQ(edit_distance("mass_kg", "mass_kg"), 0U);
  EXPECT_EQ(edit_distance("", "mass"), 4U);
  EXPECT_EQ(edit_distance("mass", ""), 4U);
  EXPECT_EQ(edit_distance("mas_kg", "mass_kg"), 1U);
  EXPECT_EQ(edit_distance("masss_kg", "mass_kg"), 1U);
  EXPECT_EQ(edit_distance("mess_kg", "mass_kg"), 1U);
  EXPECT_EQ(edit_distance("period", "friction"), 6U);
}

TEST(Numbers, ThatAreComparedDifferInTheirTextsAsSoonAsTheyDiffer) {
  const auto texts = [](double value, double limit) {
    const auto [value_text, limit_text] = compared(value, limit);
    return value_text + " " + limit_text;
  };
  EXPECT_EQ(texts(4.5, 4), "4.5 4");
  EXPECT_EQ(texts(1.0 / 3, 0.25), "0.333334 0.25") << "six digits are enough";
  EXPECT_EQ(texts(0.03814699, 0.038146972), "0.03814699 0.03814697");
  EXPECT_EQ(texts(2.0 / 3, 1.0 / 3), "0.666667 0.333333") << "away from each other";
  EXPECT_EQ(texts(4.0 / 3, 2.0 / 3), "1.33334 0.666666");
  EXPECT_EQ(texts(2.0 / 3, 4.0 / 3), "0.666666 1.33334");
  EXPECT_EQ(texts(0.1 + 0.2, 0.25), "0.3 0.25") << "no digit for what arithmetic rounded";
  EXPECT_EQ(texts(9.999996, 9), "10 9");
  EXPECT_EQ(texts(-1.0 / 3, -2.0 / 3), "-0.333333 -0.666667");
  EXPECT_EQ(texts(std::numeric_limits<double>::infinity(), 2.0 / 3), "inf 0.666666");
  EXPECT_EQ(texts(3681.0000001, 3681), "3681.0000001 3681");
  EXPECT_EQ(texts(1, std::nextafter(1.0, 2.0)), "1 1.0000000000000002");
  EXPECT_EQ(texts(1.0 / 3, 1.0 / 3), "0.333333 0.333333");
}

TEST(Numbers, ThatAreNotFiniteOrTooSmallAreRefusedByName) {
  for (const double bad : {-1.0, 0.0, HUGE_VAL, std::nan("")})
    EXPECT_EQ(refusal([&] { require_positive("a", bad); }), "a is " + to_text(bad) + "; give a finite number above 0");
  for (const double bad : {-1.0, HUGE_VAL, std::nan("")})
    EXPECT_NE(refusal([&] { require_not_negative("a", bad); }).find("give a finite number, 0 or above"),
              std::string::npos);
  EXPECT_EQ(refusal([] { require_not_negative("a", 0.0), require_positive("a", 5e-324); }), "");
}

}  // namespace
}  // namespace breakaway
