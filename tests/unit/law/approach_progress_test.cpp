#include "breakaway/law/approach_progress.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "breakaway/law/braked_kicks.hpp"

namespace breakaway::law {
namespace {

constexpr double one_period_s = 1e-3;

// An axis hardly gets on below a millimetre a second.
ApproachProgress<double> progress_of_spans() {
  BrakedKicks<double> k;
  k.patient_periods = 20;
  k.approach.switch_speed_m_s = 0.064;
  ApproachProgress<double> progress{k, 1, one_period_s};
  progress.restart();
  return progress;
}

// Periods until an axis with this place in period k is taken for stuck; 0: never in a second.
template <class Place>
int periods_until_stuck(const Place& place_m) {
  ApproachProgress<double> progress = progress_of_spans();
  for (int n = 1; n <= 1000; ++n)
    if (progress.hardly_gets_on(place_m(n * one_period_s))) return n;
  return 0;
}

TEST(ApproachProgress, AnAxisThatCreepsIsFoundInItsSecondSpan) {
  EXPECT_EQ(periods_until_stuck([](double t) { return -0.1 + 0.9e-3 * t; }), 40);
  EXPECT_EQ(periods_until_stuck([](double t) { return 0.1 - 0.9e-3 * t; }), 40);
  EXPECT_EQ(periods_until_stuck([](double) { return 0.1; }), 40);
  EXPECT_EQ(periods_until_stuck([](double t) { return -0.1 + 1.2e-3 * t; }), 0);
}

TEST(ApproachProgress, AnAxisThatIsSlowAtFirstButGainsIsNot) {
  EXPECT_EQ(periods_until_stuck([](double t) { return -0.1 + 1e-3 * t * t; }), 0);
}

// Once it is on its way back it is where it was before.
TEST(ApproachProgress, AnAxisThatTurnsRoundIsNot) {
  for (const double side : {1.0, -1.0}) {
    for (const double turns_at_s : {0.019, 0.02, 0.03, 0.05, 0.1}) {
      const auto parabola = [=](double t) { return side * (0.1 - 0.05 * (t - turns_at_s) * (t - turns_at_s)); };
      EXPECT_EQ(periods_until_stuck(parabola), 0) << turns_at_s;
    }
  }
}

TEST(ApproachProgress, AnAxisThatTurnsRoundBehindItsTargetIsNot) {
  for (const double turns_at_s : {0.03, 0.05, 0.1}) {
    const auto there = [=](double t) { return 1e-4 - 0.05 * (t - turns_at_s) * (t - turns_at_s); };
    EXPECT_EQ(periods_until_stuck([&](double t) { return t < 2 * turns_at_s ? there(t) : -1 + t; }), 0) << turns_at_s;
  }
}

// What slips and is bent back again and again gets nowhere.
TEST(ApproachProgress, AnAxisThatComesAndGoesIsFound) {
  for (const double span_s : {0.02, 0.013, 0.04}) {
    const int found =
        periods_until_stuck([=](double t) { return 0.1 + 2e-6 * std::sin(2 * 3.14159 * t / span_s / 1.7); });
    EXPECT_GT(found, 0);
    EXPECT_LE(found, 100);
  }
}

TEST(ApproachProgress, AfterARestartASpanIsHeldAgainstNoneBefore) {
  ApproachProgress<double> progress = progress_of_spans();
  for (int n = 1; n <= 39; ++n) EXPECT_FALSE(progress.hardly_gets_on(-0.1 + 0.5 * n * one_period_s));
  progress.restart();
  for (int n = 1; n <= 39; ++n) EXPECT_FALSE(progress.hardly_gets_on(0.1)) << n;
  EXPECT_TRUE(progress.hardly_gets_on(0.1));
}

}  // namespace
}  // namespace breakaway::law
