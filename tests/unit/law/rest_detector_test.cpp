#include "breakaway/law/rest_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace breakaway::law {
namespace {

constexpr double m = 1, f_lo = 2.5, q = 1e-6, T = 1e-3;

int periods_until_rest(RestDetector<double>& rest, double position_m, double force_N) {
  for (int n = 0; n <= RestDetector<double>::patience + 1; ++n) {
    if (rest.update(position_m, force_N)) return n;
  }
  return -1;
}

TEST(RestDetector, WaitsTheTimeInWhichTheSlowestStopCrossesOneCount) {
  struct Case {
    const char* label;
    double force_N;
  };
  for (const auto& [label, force_N] :
       {Case{"no force", 0}, Case{"half of friction", 1.25}, Case{"nearly friction", 2.4}}) {
    RestDetector<double> rest{m, f_lo, q, T};
    const double window_s = std::sqrt(2 * q * m / (f_lo - force_N));
    EXPECT_EQ(periods_until_rest(rest, 3e-6, force_N), static_cast<int>(std::ceil(window_s / T))) << label;
  }
}

// The claim itself, on random stops under a deceleration that is just lawful: whenever rest is certified, the axis
// rests.
TEST(RestDetector, NeverCertifiesAMovingAxis) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> unit{0, 1};
  int certified = 0;
  for (int run = 0; run < 20000; ++run) {
    const double force_N = 2.4 * unit(random);
    const double deceleration = (f_lo - force_N) / m * (1 + unit(random) * unit(random));
    const double speed = 5e-3 * unit(random), start_m = q * unit(random);
    const double stop_s = speed / deceleration;
    RestDetector<double> rest{m, f_lo, q, T};
    for (int k = 0; k < 40; ++k) {
      const double t = std::min(k * T, stop_s);
      const double x = start_m + speed * t - deceleration * t * t / 2;
      if (!rest.update(std::round(x / q) * q, force_N)) continue;
      EXPECT_GE(k * T, stop_s * (1 - 1e-12)) << "run " << run;
      ++certified;
      break;
    }
  }
  EXPECT_GT(certified, 19000);
}

TEST(RestDetector, IgnoresSamplesFromBeforeAPulseActed) {
  RestDetector<double> rest{m, f_lo, q, T};
  ASSERT_GT(periods_until_rest(rest, 5e-6, 0), 0);
  rest.restart(1);
  EXPECT_FALSE(rest.update(5e-6, 0)) << "shows the axis before the pulse";
  EXPECT_FALSE(rest.update(5e-6, 0)) << "the first sample after it";
  EXPECT_TRUE(rest.update(5e-6, 0));
}

TEST(RestDetector, TakesAnAxisForStuckAfterItsPatienceWhenForceExceedsTheLowerBound) {
  RestDetector<double> rest{m, f_lo, q, T};
  EXPECT_EQ(periods_until_rest(rest, 0, 3.0), RestDetector<double>::patience);
}

TEST(RestDetector, StartsAgainAtEveryChangeOfCount) {
  RestDetector<double> rest{m, f_lo, q, T};
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(rest.update(i * q, 0));
}

}  // namespace
}  // namespace breakaway::law
