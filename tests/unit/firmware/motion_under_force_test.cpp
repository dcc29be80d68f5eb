#include "breakaway/firmware/motion_under_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace breakaway::firmware {
namespace {

constexpr double mass_kg = 1, friction_upper_N = 4.5, resolution_m = 1e-6, step_s = 1e-3;

int samples_until_missing(MotionUnderForce<double>& motion, double force_N, int most, double period_s = step_s) {
  for (int sample = 1; sample <= most; ++sample) {
    motion.sample(0, force_N, period_s);
    if (motion.missing()) return sample;
  }
  return most;
}

TEST(MotionUnderForce, SeesAnEncoderThatStandsStillUnderFullForce) {
  struct Row {
    double period_s;
    int samples;
  };
  for (const auto& [period_s, samples] : {Row{2.5e-4, 40}, Row{1e-3, 10}, Row{2e-3, 5}, Row{4e-3, 5}})
    for (const double force_N : {50.0, -50.0}) {
      MotionUnderForce<double> motion{mass_kg, friction_upper_N, resolution_m};
      const int first = force_N > 0 ? 1 : 0;  // it shows that the force turned
      EXPECT_EQ(samples_until_missing(motion, force_N, 1000, period_s), samples + first);
      MotionUnderForce<float> flashed{1, 4.5F, 1e-6F};
      int needed = 0;
      while (!flashed.missing() && needed < 1000) {
        flashed.sample(0, static_cast<float>(force_N), static_cast<float>(period_s));
        ++needed;
      }
      EXPECT_LE(needed, samples + 1);
    }
}

TEST(MotionUnderForce, BeginsAnewWithEveryCountAndEveryTurnOfTheForce) {
  MotionUnderForce<double> motion{mass_kg, friction_upper_N, resolution_m};
  for (int period = 0; period < 1000; ++period) {
    motion.sample(period % 9 == 0 ? resolution_m : 0, 50, step_s);
    ASSERT_FALSE(motion.missing());
  }
  for (int period = 0; period < 1000; ++period) {
    motion.sample(0, period / 9 % 2 == 0 ? 50 : -50, step_s);
    ASSERT_FALSE(motion.missing());
  }
}

// Twenty counts take sqrt(40 q m / (F - f_upper)): 90 ms for 0.1 N beyond friction and counts of 20 um.
TEST(MotionUnderForce, WaitsForAsLongAsTwentyCountsTake) {
  MotionUnderForce<double> motion{mass_kg, friction_upper_N, 20e-6};
  const int samples = samples_until_missing(motion, friction_upper_N + 0.1, 1000);
  EXPECT_NEAR(samples, 89, 3);
}

TEST(MotionUnderForce, WaitsForWhatASpringTakesUpBesides) {
  MotionUnderForce<double> motion{mass_kg, friction_upper_N, 20e-6, 3 * 400e-6};
  EXPECT_NEAR(samples_until_missing(motion, friction_upper_N + 0.1, 1000), 179, 3);
}

TEST(MotionUnderForce, WaitsLongerForALargerMass) {
  MotionUnderForce<double> motion{4, friction_upper_N, 20e-6};
  EXPECT_NEAR(samples_until_missing(motion, friction_upper_N + 0.1, 1000), 179, 3);
}

// From no force on, which pushes neither way.
TEST(MotionUnderForce, AForceThatBeginsUpwardsIsATurn) {
  for (const double force_N : {50.0, -50.0}) {
    MotionUnderForce<double> motion{mass_kg, friction_upper_N, resolution_m};
    motion.sample(0, 0, step_s);
    EXPECT_EQ(samples_until_missing(motion, force_N, 1000), force_N > 0 ? 11 : 10);
  }
}

TEST(MotionUnderForce, SeesSmallForcesBeyondSmallFriction) {
  for (const double sign : {1.0, -1.0}) {
    MotionUnderForce<double> motion{mass_kg, 0.2, resolution_m};
    motion.sample(0, sign * 0.5, step_s);
    EXPECT_LE(samples_until_missing(motion, sign * 0.5, 1000), 13);
    EXPECT_TRUE(motion.missing());
  }
}

TEST(MotionUnderForce, TheTimeUnderAForceThatFrictionMayHoldDoesNotCount) {
  MotionUnderForce<double> motion{mass_kg, friction_upper_N, resolution_m};
  for (int period = 0; period < 100; ++period) motion.sample(0, -friction_upper_N, step_s);
  EXPECT_EQ(samples_until_missing(motion, -50, 1000), 10);
}

// Samples without time but the last, so that both sums are exact.
TEST(MotionUnderForce, ATieIsNoMissingMotion) {
  const auto is_missing_after = [](double time_s, double excess_N, double q_m) {
    MotionUnderForce<double> motion{mass_kg, 4, q_m};
    for (int sample = 0; sample < 4; ++sample) motion.sample(0, -4 - excess_N, 0);
    motion.sample(0, -4 - excess_N, time_s);
    return motion.missing();
  };
  constexpr double least_s = 0.99 * MotionUnderForce<double>::least_time_s;
  EXPECT_FALSE(is_missing_after(least_s, 50, 1e-9));
  EXPECT_TRUE(is_missing_after(std::nextafter(least_s, 1.0), 50, 1e-9));
  EXPECT_FALSE(is_missing_after(0.5, 1.25, 1.0 / 64)) << "exactly twenty counts";
  EXPECT_TRUE(is_missing_after(0.5, 1.2501, 1.0 / 64));
}

TEST(MotionUnderForce, AllowsAnyForceThatFrictionMayHold) {
  MotionUnderForce<double> motion{mass_kg, friction_upper_N, resolution_m};
  EXPECT_EQ(samples_until_missing(motion, friction_upper_N, 5000), 5000);
  EXPECT_FALSE(motion.missing());
}

TEST(MotionUnderForce, AllowsPulsesThatAnAxisDoesNotFollow) {
  MotionUnderForce<double> motion{mass_kg, friction_upper_N, resolution_m};
  for (int period = 0; period < 5000; ++period) {
    motion.sample(0, period % 12 < 9 ? 50 : 0, step_s);
    ASSERT_FALSE(motion.missing()) << "a kick that fails is the law's to name";
  }
}

// A mass under random forces with friction anywhere inside its bound, read by an encoder of whole counts: lawful motion
// is never taken for none, reversals included.
TEST(MotionUnderForce, NeverDoubtsAMassThatMovesAsItMust) {
  std::mt19937_64 random{3};
  std::uniform_real_distribution<double> unit{0, 1};
  for (const double q_m : {1e-9, 1e-6, 1e-3}) {
    MotionUnderForce<double> motion{mass_kg, friction_upper_N, q_m};
    double x_m = 0, v_m_s = 0, force_N = 0, shown = 0;
    for (int period = 0; period < 100'000; ++period) {
      if (random() % 40 == 0) force_N = (unit(random) - 0.5) * (random() % 2 == 0 ? 100 : 12);
      constexpr int parts = 20;
      for (int i = 0; i < parts; ++i) {
        const double dt_s = step_s / parts, friction_N = friction_upper_N * (1 - 0.5 * unit(random) * (period % 2));
        const double free_m_s = v_m_s + force_N / mass_kg * dt_s, braked_m_s = friction_N / mass_kg * dt_s;
        v_m_s = std::abs(free_m_s) <= braked_m_s ? 0 : free_m_s - std::copysign(braked_m_s, free_m_s);
        x_m += v_m_s * dt_s;
      }
      const double before = std::exchange(shown, std::round(x_m / q_m));
      motion.sample(q_m * (shown - before), force_N, step_s);
      ASSERT_FALSE(motion.missing()) << "q " << q_m << " m in period " << period;
    }
  }
}

TEST(MotionUnderForce, WatchesNothingWithoutABoundOfFriction) {
  MotionUnderForce<double> motion{mass_kg, std::numeric_limits<double>::infinity(), resolution_m};
  EXPECT_EQ(samples_until_missing(motion, 1e300, 1000), 1000);
  EXPECT_FALSE(motion.missing());
}

}  // namespace
}  // namespace breakaway::firmware
