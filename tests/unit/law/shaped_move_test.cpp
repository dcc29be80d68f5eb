// The move that leaves nothing swinging.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "belt_fixture.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::law::work_test {
namespace {

// The force of a plan that nothing feeds back to, at this frequency.
double swing_left(const ShapedApproach<double>& approach, double start_m, double frequency_Hz) {
  ShapedMove<double> move{approach, 1e-3, 10, 1};
  std::complex<double> sum = 0;
  double all = 0;
  for (int k = 0; k < 5000 && !move.see(start_m, 0, 0); ++k) {
    const double force_N = move.force_N();
    sum += force_N * std::polar(1.0, -2 * std::numbers::pi * frequency_Hz * k * 1e-3);
    all += std::abs(force_N);
  }
  return std::abs(sum) / all;
}

TEST(ShapedMove, LeavesNothingSwingingAtTheResonance) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = 0;
  for (const double start_m : {-0.1, 0.037, -4e-3}) {
    EXPECT_LT(swing_left(approach, start_m, 50), 1e-12) << start_m;
    EXPECT_GT(swing_left(approach, start_m, 3), 1e-3) << start_m;
  }
}

TEST(ShapedMove, GoesAsFarAsItPlansAndKeepsItsLimits) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = 0;
  for (const double most_m_s : {10.0, 0.3}) {
    for (const double start_m : {-0.4, 0.1, 0.02}) {
      ShapedMove<double> move{approach, 1e-3, most_m_s, 1};
      double x = start_m, v = 0;
      while (!move.see(x, 0, 0)) {
        const double a = move.force_N() / approach.mass_kg;
        EXPECT_LE(std::abs(a), approach.acceleration_m_s2 * (1 + 1e-9));
        x += (v + a * 0.5e-3) * 1e-3;
        v += a * 1e-3;
        EXPECT_LE(std::abs(v), most_m_s * (1 + 1e-9));
      }
      EXPECT_NEAR(std::abs(x), approach.short_of_target_m, 1e-12) << start_m;
      EXPECT_NEAR(v, 0, 1e-12) << start_m;
    }
  }
}

// A plan that waited would be left behind by the way of a period each time, and its force be missing in the swing.
TEST(ShapedMove, GoesOnByItsPlanWhereReadingsAreLost) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = 0;
  for (const int one_of : {2, 7, 40}) {
    ShapedMove<double> move{approach, 1e-3, 10, 1};
    double x = -0.4, v = 0;
    for (int k = 0;; ++k) {
      const Reading reading = k % one_of == 1 ? Reading::lost : Reading::there;
      if (move.see(x, 0, 0, reading)) break;
      const bool asked = reading == Reading::there || move.reckons();
      const double a = asked ? move.force_N() / approach.mass_kg : 0;
      x += (v + a * 0.5e-3) * 1e-3;
      v += a * 1e-3;
    }
    EXPECT_NEAR(x, -approach.short_of_target_m, 1e-12) << one_of;
    EXPECT_NEAR(v, 0, 1e-12) << one_of;
  }
}

// As fast as two periods of its acceleration, and as a hundredth of one.
TEST(ShapedMove, IsNoFasterThanItMayWhereAPeriodOfItsAccelerationAlreadyIs) {
  auto approach = design::design_work_kicks<float>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = approach.short_of_target_m = 0;
  for (const float share : {2.0F, 0.01F}) {
    const float most_m_s = share * approach.acceleration_m_s2 * 1e-3F;
    ShapedMove<float> move{approach, 1e-3F, most_m_s, 1};
    const double start_m = -2e5 * static_cast<double>(most_m_s) * 1e-3;
    double x = start_m, v = 0;
    while (!move.see(static_cast<float>(x), 0, 0)) {
      const double a = static_cast<double>(move.force_N() / approach.mass_kg);
      x += (v + a * 0.5e-3) * 1e-3;
      v += a * 1e-3;
      ASSERT_LE(std::abs(v), static_cast<double>(most_m_s) * (1 + 1e-5)) << share;
    }
    EXPECT_NEAR(x, 0, 1e-5 * std::abs(start_m)) << "rounding adds up over two hundred thousand periods, " << share;
  }
}

TEST(ShapedMove, GoesNoFasterWhereItsTargetIsFurtherThanItCountsPeriods) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = 0;
  ShapedMove<double> move{approach, 1e-3, 0.1, 1};
  double x = -1000, v = 0, most_m_s = 0;
  while (!move.see(x, 0, 0)) {
    const double a = move.force_N() / approach.mass_kg;
    x += (v + a * 0.5e-3) * 1e-3;
    v += a * 1e-3;
    most_m_s = std::max(most_m_s, v);
  }
  EXPECT_LE(most_m_s, 0.1 * (1 + 1e-9));
  EXPECT_NEAR(v, 0, 1e-9);
  EXPECT_GT(x, -1000 + 0.5 * 0.1 * 1e-3 * ShapedMove<double>::most_planned_periods) << "it leads at least as far";
}

// A swing of eight periods is its own negative after four.
TEST(ShapedMove, SeesNoSwingInAPlaceThatIsTheMeanOfTwoReadings) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.damping_Ns_per_m = 0;
  for (const int mean_periods : {4, 0}) {
    approach.mean_periods = static_cast<std::uint8_t>(mean_periods);
    ShapedMove<double> calm{approach, 1e-3, 10, 1}, swinging{approach, 1e-3, 10, 1};
    double most_apart_N = 0;
    for (int k = 0; k < 60; ++k) {
      const double swing_m = 1e-3 * std::cos(2 * std::numbers::pi * k / 8);
      calm.see(-0.1, 0, 0);
      swinging.see(-0.1 + (k > 0 ? swing_m : 0), 0, 0);
      const double apart_N = swinging.force_N() - calm.force_N();
      if (k > 8) most_apart_N = std::max(most_apart_N, std::abs(apart_N));
    }
    const double expected_N = mean_periods > 0 ? 0 : 1e-3 * approach.stiffness_N_per_m;
    EXPECT_NEAR(most_apart_N, expected_N, 1e-9 * approach.stiffness_N_per_m) << mean_periods;
  }
}

// Friction of 3.5 N stops 1 kg at 10 m/s within so many periods of a millisecond.
constexpr double stop_periods = 1 * 10 / (3.5 * 1e-3);

TEST(ShapedMove, SaysWhichWayItGoesAndForHowManyPeriods) {
  const auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  for (const double side : {1.0, -1.0}) {
    ShapedMove<double> move{approach, 1e-3, 10, 1};
    move.see(-side * 0.1, 0, 0);
    EXPECT_EQ(move.heading(), side);
    int periods = 0;
    for (; !move.see(-side * 0.1, 0, 0); ++periods) static_cast<void>(move.force_N());
    EXPECT_NEAR(move.braking_periods(), periods + stop_periods, 1);
  }
}

// Thirty thousand periods of speeding up are the most that it counts.
TEST(ShapedMove, CountsThePeriodsOfTheLongestWayAndTheHighestSpeed) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.short_of_target_m = 0;
  approach.acceleration_m_s2 = 1;
  ShapedMove<double> move{approach, 1e-3, 1e9, 1};
  move.see(-1e-6 * 30000.0 * 40000.0, 0, 0);
  const double planned = 2 * 30000 + (40000 + 1 - 30000) + approach.swing_periods;
  EXPECT_NEAR(move.braking_periods(), planned + 1e8 * stop_periods, 1e-3);
}

TEST(ShapedMove, BeginsAnewFromWhereTheAxisIsWhenItsTargetMoves) {
  const auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  ShapedMove<double> move{approach, 1e-3, 10, 1}, begun_there{approach, 1e-3, 10, 1};
  for (int k = 0; k < 20; ++k) {
    move.see(-0.1, 0, 0);
    static_cast<void>(move.force_N());
  }
  move.retarget(0.05);
  for (int k = 0; k < 200; ++k) {
    EXPECT_EQ(move.see(-0.15, 0, 0), begun_there.see(-0.15, 0, 0)) << k;
    EXPECT_EQ(move.force_N(), begun_there.force_N()) << k;
  }
}

}  // namespace
}  // namespace breakaway::law::work_test
