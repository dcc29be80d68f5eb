#include "breakaway/design/assumptions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "../refusal.hpp"

namespace {

using namespace breakaway::design;
using breakaway::testing::refusal;
using FrictionBounds = breakaway::law::FrictionBounds<double>;

UnitKick<double> kick_with(double zeta) { return K3<double>::make({1.0, 1.0, 2 * zeta, 1.0}).unit(); }

// tests/reference/assumptions.csv, made by tests/reference/assumptions.py.
TEST(Assumption3, ThresholdsAgreeWithHighPrecisionReference) {
  std::ifstream file(BREAKAWAY_SOURCE_DIR "/tests/reference/assumptions.csv");
  std::string line;
  std::getline(file, line);
  int rows = 0;
  double zeta = 0, by_18 = 0, exact = 0;
  char comma = 0;
  for (; file >> zeta >> comma >> by_18 >> comma >> exact; ++rows) {
    EXPECT_NEAR(ratio_threshold_18(kick_with(zeta)), by_18, 1e-14) << "zeta " << zeta;
    EXPECT_NEAR(exact_ratio_threshold(kick_with(zeta)), exact, 1e-14) << "zeta " << zeta;
  }
  EXPECT_EQ(rows, 10);
}

TEST(Assumption3, ThresholdsHaveTheirLimitsAtCriticalDamping) {
  const auto kick = kick_with(1 + 1e-14);
  EXPECT_NEAR(ratio_threshold_18(kick), 1 - std::exp(-1), 1e-7);  // Remark 1; falls like sqrt(zeta - 1)
  EXPECT_NEAR(exact_ratio_threshold(kick), 0.26103, 1e-5);
}

TEST(Assumption3, IsRemarkOnesWhereBothPolesAreTheSame) {
  constexpr UnitKick<double> critical{.rho = 1, .epsilon = 0};
  EXPECT_DOUBLE_EQ(ratio_threshold_18(critical), -std::expm1(-1));
  EXPECT_NEAR(exact_ratio_threshold(critical), 0.26103, 1e-5);
}

TEST(Assumption3, MoreDampingToleratesMoreUncertainty) {
  double last_18 = 1, last_exact = 1;
  for (double zeta = 1.0001; zeta < 1e3; zeta *= 1.3) {
    const auto kick = kick_with(zeta);
    EXPECT_LT(ratio_threshold_18(kick), last_18);
    EXPECT_LT(exact_ratio_threshold(kick), last_exact);
    EXPECT_LT(exact_ratio_threshold(kick), ratio_threshold_18(kick)) << "(18) is sufficient; zeta " << zeta;
    last_18 = ratio_threshold_18(kick);
    last_exact = exact_ratio_threshold(kick);
  }
}

TEST(Remark1, FindsTheLeastDampingThatSatisfies18) {
  for (const double ratio : {1e-15, 1e-9, 1e-3, 0.1, 0.28, 0.5, 0.6, 0.63, 0.6321}) {
    const double m = 0.37, k1 = 1234.5;
    const FrictionBounds friction{ratio * 3, 3};
    const auto damping = least_damping_for_18(m, k1, friction);
    ASSERT_TRUE(damping) << "ratio " << ratio;
    const auto holds = [&](double k22) {
      return friction.ratio() > ratio_threshold_18(K3<double>::make({m, k1, k22, 1.0}).unit());
    };
    EXPECT_TRUE(holds(*damping)) << "ratio " << ratio;
    // 1e-12: near ratio = 1 - 1/e the threshold is flat in k22 only as far as double tells.
    EXPECT_FALSE(holds(*damping * (1 - 1e-12))) << "ratio " << ratio;
  }
}

TEST(Remark1, GivesTheFirstOverdampedNumberWhenAnyWillDo) {
  for (const double ratio : {0.64, 0.9, 1.0}) {
    const auto damping = least_damping_for_18(1.0, 1.0, {ratio, 1.0});
    ASSERT_TRUE(damping);
    EXPECT_EQ(*damping, std::nextafter(2.0, 3.0)) << "ratio " << ratio;
  }
}

TEST(Remark1, RefusesBadInputByName) {
  const auto message = [](double mass_kg, const FrictionBounds& friction) {
    return refusal([&] { least_damping_for_18(mass_kg, 1, friction); });
  };
  EXPECT_NE(message(0, {1, 2}).find("mass_kg is 0"), std::string::npos);
  EXPECT_NE(message(1, {2, 1}).find("friction_lower_N is 2, above"), std::string::npos);
  EXPECT_NE(message(1, {0, 1}).find("friction_lower_N is 0"), std::string::npos);
}

TEST(Remark1, FindsNoneForARatioTooSmallForAnyDamping) {
  EXPECT_EQ(least_damping_for_18(1e308, 1e308, {1e-300, 1}), std::nullopt);
}

// Section V of [I]: t2 = 4.3964398 and y2 = -0.1745932 recomputed to 8 digits give t2 + bound = 5.5176315.
TEST(FiniteTimeBound, MatchesTheExample) {
  EXPECT_NEAR(4.3964398 + finite_time_bound_s(1.0, {2.5, 4.5}, -0.1745932), 5.5176315, 2e-7);
}

TEST(FiniteTimeBound, IsTheLimitOfAGeometricSeriesOfKicks) {
  // Under f_lower from y, T = sqrt(2 m y / f_lower) is the longest kick; each leaves at most (1 - ratio) y.
  const FrictionBounds friction{1.0, 3.0};
  double sum = 0, y = 0.2;
  for (int i = 0; i < 400; ++i, y *= friction.gap()) sum += std::sqrt(2 * 0.7 * y / friction.lower_N);
  EXPECT_NEAR(finite_time_bound_s(0.7, friction, 0.2), sum, 1e-13);
  // and for known friction a single kick is left.
  EXPECT_DOUBLE_EQ(finite_time_bound_s(0.7, {2.0, 2.0}, 0.2), std::sqrt(2 * 0.7 * 0.2 / 2));
}

// A pulse of one period that just equals f_upper, against f_lower, then coasting: by the two parabolas.
TEST(AccuracyFloor, IsTheDisplacementOfTheLeastSurePulse) {
  const FrictionBounds friction{2.5, 4.5};
  const double m = 1.3, period = 1e-3;
  const double up = (friction.upper_N - friction.lower_N) / m, down = friction.lower_N / m;
  const double speed = up * period;
  EXPECT_NEAR(accuracy_floor_m(m, friction, period), speed * period / 2 + speed * speed / (2 * down), 1e-20);
  EXPECT_DOUBLE_EQ(accuracy_floor_m(1.0, friction, 1e-3), 1.8e-6);
}

}  // namespace
