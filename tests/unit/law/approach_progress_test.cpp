#include "breakaway/law/approach_progress.hpp"

#include <gtest/gtest.h>

#include "breakaway/law/braked_kicks.hpp"

namespace breakaway::law {
namespace {

constexpr double one_period_s = 1e-3;

BrakedKicks<double> kicks_of_spans() {
  BrakedKicks<double> k;
  k.patient_periods = 20;
  k.approach.switch_speed_m_s = 0.064;  // an axis hardly gets on below a millimetre a second
  return k;
}

// Periods until an axis with this place in period k is taken for stuck; 0: never in a second.
template <class Place>
int periods_until_stuck(const Place& place_m) {
  const BrakedKicks<double> k = kicks_of_spans();
  ApproachProgress<double> progress;
  progress.restart();
  for (int n = 1; n <= 1000; ++n)
    if (progress.hardly_gets_on(place_m(n * one_period_s), k, 1, one_period_s)) return n;
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

TEST(ApproachProgress, AfterARestartASpanIsHeldAgainstNoneBefore) {
  const BrakedKicks<double> k = kicks_of_spans();
  ApproachProgress<double> progress;
  progress.restart();
  for (int n = 1; n <= 39; ++n)
    EXPECT_FALSE(progress.hardly_gets_on(-0.1 + 0.5 * n * one_period_s, k, 1, one_period_s));
  progress.restart();
  for (int n = 1; n <= 39; ++n) EXPECT_FALSE(progress.hardly_gets_on(0.1, k, 1, one_period_s)) << n;
  EXPECT_TRUE(progress.hardly_gets_on(0.1, k, 1, one_period_s));
}

}  // namespace
}  // namespace breakaway::law
