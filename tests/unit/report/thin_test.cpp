// Thinned curves look the same: what a picture can show of them is still there.
#include "thin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using breakaway::report::most_of_series;
using breakaway::report::Point;
using breakaway::report::thin_curve;
using breakaway::report::thin_series;

std::vector<Point> wave(int count) {
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) points.push_back({i * 1e-3, std::sin(i * 0.01)});
  return points;
}

TEST(ThinSeries, LeavesAShortSeriesAlone) { EXPECT_EQ(thin_series(wave(400), 100).size(), 400u); }

TEST(ThinSeries, KeepsEveryPeakOfALongOneInOrder) {
  auto points = wave(100'000);
  points[31'234].y = 7;
  points[31'236].y = -9;
  const auto thin = thin_series(points, 100);
  EXPECT_LE(thin.size(), most_of_series(101));
  EXPECT_TRUE(std::ranges::is_sorted(thin, {}, &Point::x));
  const auto [least, most] = std::ranges::minmax(thin, {}, &Point::y);
  EXPECT_EQ(most.y, 7);
  EXPECT_EQ(most.x, points[31'234].x);
  EXPECT_EQ(least.y, -9);
  EXPECT_EQ(thin.front().x, points.front().x);
  EXPECT_EQ(thin.back().x, points.back().x);
}

TEST(ThinSeries, KeepsGaps) {
  auto points = wave(10'000);
  for (int i = 2000; i < 7000; ++i) points[static_cast<std::size_t>(i)].y = std::nan("");
  const auto thin = thin_series(points, 100);
  EXPECT_EQ(std::ranges::count_if(thin, [](const Point& p) { return std::isnan(p.y); }), 1);
  EXPECT_TRUE(std::ranges::none_of(thin, [](const Point& p) { return p.x > 2.0 && p.x < 7.0 && !std::isnan(p.y); }));
}

TEST(ThinCurve, StaysWithinTheToleranceWithFewPoints) {
  std::vector<Point> circle;
  for (int i = 0; i <= 10'000; ++i) circle.push_back({std::cos(i * 6e-4), 100 * std::sin(i * 6e-4)});
  const auto thin = thin_curve(circle, 1e-3, 0.1);
  EXPECT_LT(thin.size(), 200u);
  // The chord of an arc is off by its sagitta: in units of the radius both tolerances are 1e-3.
  for (std::size_t i = 1; i < thin.size(); ++i) {
    const double half_chord = std::hypot(thin[i].x - thin[i - 1].x, (thin[i].y - thin[i - 1].y) / 100) / 2;
    EXPECT_LE(1 - std::sqrt(1 - half_chord * half_chord), 1.001e-3);
  }
}

TEST(ThinCurve, KeepsBothEndsOfAnAxisThatStands) {
  EXPECT_EQ(thin_curve(std::vector<Point>(5000, Point{1, 0}), 1e-3, 1e-3).size(), 2u);
}

}  // namespace
