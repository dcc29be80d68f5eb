// Every value of a histogram is in one bin.
#include "histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace breakaway::report {
namespace {

std::size_t all(const Histogram& h) { return std::accumulate(h.counts.begin(), h.counts.end(), std::size_t{0}); }

TEST(Histogram, CountsEachValueOnce) {
  std::vector<double> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(std::sin(i) * 1e-6);
  const Histogram h = histogram_of(values, 24);
  EXPECT_EQ(h.counts.size(), 24U);
  EXPECT_EQ(all(h), values.size());
}

TEST(Histogram, HasTheGreatestValueInItsLastBin) {
  const Histogram h = histogram_of({0, 1, 2, 3, 4}, 4);
  EXPECT_EQ(h.counts, (std::vector<std::size_t>{1, 1, 1, 2}));
  EXPECT_DOUBLE_EQ(h.middle(3), 3.5);
}

TEST(Histogram, PassesOverWhatNeverCame) {
  EXPECT_EQ(all(histogram_of({1, NAN, 2, INFINITY}, 5)), 2U);
  EXPECT_TRUE(histogram_of({NAN}, 5).counts.empty());
  EXPECT_TRUE(histogram_of({}, 5).counts.empty());
}

TEST(Histogram, HasOneBinAroundEqualValues) {
  for (const double value : {0.0, 0.25, -3e-7}) {
    const Histogram h = histogram_of({value, value, value}, 24);
    EXPECT_EQ(h.counts, (std::vector<std::size_t>{3}));
    EXPECT_NEAR(h.middle(0), value, 1e-12);
    EXPECT_GT(h.width, 0);
  }
}

}  // namespace
}  // namespace breakaway::report
