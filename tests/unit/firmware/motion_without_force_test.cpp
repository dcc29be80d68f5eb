#include "breakaway/firmware/motion_without_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

namespace breakaway::firmware {
namespace {

constexpr double held_N = 2, allowed_m = 0.5, count_m = 0x1p-30;

// An axis that the law has begun to hold.
MotionWithoutForce<double> held_axis(bool is_rigid = true) {
  MotionWithoutForce<double> motion{{held_N, allowed_m, is_rigid}, count_m};
  motion.restart();
  motion.sample(0, true);
  return motion;
}

TEST(MotionWithoutForce, SeesAHeldAxisThatIsMovedByMoreThanIsAllowed) {
  for (const double sign : {1.0, -1.0}) {
    auto motion = held_axis();
    motion.sample(sign * 0.25, true);
    motion.sample(sign * 0.25, true);
    EXPECT_FALSE(motion.seen()) << "exactly what is allowed";
    motion.sample(sign * count_m, true);
    EXPECT_TRUE(motion.seen());
  }
}

TEST(MotionWithoutForce, GoesOnWhenTheLawLeavesItsHold) {
  for (const double sign : {1.0, -1.0}) {
    auto motion = held_axis();
    for (int n = 0; n < 6; ++n) {
      EXPECT_FALSE(motion.seen());
      motion.sample(sign * 0.1, n < 2);
    }
    EXPECT_TRUE(motion.seen());
  }
}

// The law may have begun to hold an axis that was pushed since the sample that proved its rest.
TEST(MotionWithoutForce, CountsTheTravelOfTheFirstSampleOfAHold) {
  MotionWithoutForce<double> motion{{held_N, allowed_m}, count_m};
  motion.sample(0.6, true);
  EXPECT_TRUE(motion.seen());
}

TEST(MotionWithoutForce, BeginsAnewWithEveryHold) {
  auto motion = held_axis();
  for (int n = 0; n < 20; ++n) {
    motion.sample(0.4, false);
    motion.sample(0, true);
    ASSERT_FALSE(motion.seen()) << "each of these pushes was answered";
  }
}

TEST(MotionWithoutForce, DoesNotWatchBeforeAHoldOrAfterARestart) {
  MotionWithoutForce<double> motion{{held_N, allowed_m}, count_m};
  for (int n = 0; n < 10; ++n) motion.sample(1, false);
  EXPECT_FALSE(motion.seen());
  motion = held_axis();
  motion.restart();
  for (int n = 0; n < 10; ++n) motion.sample(1, false);
  EXPECT_FALSE(motion.seen());
  motion.sample(0, true);
  motion.sample(1, true);
  EXPECT_TRUE(motion.seen()) << "a hold after the restart";
}

TEST(MotionWithoutForce, AForceBeyondFrictionExplainsMotionItsWayAndNoOther) {
  for (const double way : {1.0, -1.0})
    for (const double push : {1.0, -1.0}) {
      auto motion = held_axis();
      motion.force(push * held_N);
      motion.sample(way * 0.2, false);
      motion.force(push * std::nextafter(held_N, 3.0));
      motion.sample(way * 0.4, false);
      EXPECT_EQ(motion.seen(), way != push) << "moved " << way << ", pushed " << push;
      motion.force(0);
      motion.sample(way, false);
      EXPECT_EQ(motion.seen(), way != push) << "it may coast on";
    }
}

TEST(MotionWithoutForce, AForceThatFrictionHoldsExplainsNothing) {
  for (const double way : {1.0, -1.0}) {
    auto motion = held_axis();
    for (const double force_N : {held_N, -held_N, 0.0}) motion.force(force_N);
    motion.sample(way * 0.6, true);
    EXPECT_TRUE(motion.seen());
  }
}

TEST(MotionWithoutForce, ASpringOfTheAxisMayThrowItEitherWay) {
  for (const double way : {1.0, -1.0})
    for (const double push : {1.0, -1.0}) {
      auto motion = held_axis(false);
      motion.force(push * held_N);
      motion.sample(way * 0.4, false);
      motion.force(push * 3);
      motion.sample(way * 0.4, false);
      EXPECT_FALSE(motion.seen());
    }
  auto motion = held_axis(false);
  motion.sample(0.6, false);
  EXPECT_TRUE(motion.seen()) << "but without force nothing throws it";
}

TEST(MotionWithoutForce, AForceThatIsNoNumberMayBeAny) {
  for (const double way : {1.0, -1.0}) {
    auto motion = held_axis();
    motion.force(std::nan(""));
    motion.sample(way, false);
    EXPECT_FALSE(motion.seen());
  }
}

TEST(MotionWithoutForce, WatchesNothingWhereNothingIsTold) {
  MotionWithoutForce<double> motion{law::HeldAxis<double>{}, count_m};
  motion.sample(0, true);
  motion.sample(1e300, true);
  EXPECT_FALSE(motion.seen());
}

// Readings that come again every three samples. Their travels in metres are rounded so that the sum of the three is not
// nothing: in eight hours at 1 kHz it would be 72 counts.
TEST(MotionWithoutForce, StaysWhereItIsWhenAnAxisVibratesForLong) {
  constexpr float q_m = 1e-6F;
  constexpr int readings[] = {0, -29, 46};
  MotionWithoutForce<float> motion{{2, 60 * q_m}, q_m};
  int before = 0;
  for (int n = 0; n < 30'000'000; ++n) {
    const int reading = readings[n % 3];
    motion.sample(static_cast<float>(reading - std::exchange(before, reading)) * q_m, true);
  }
  EXPECT_FALSE(motion.seen());
  motion.sample(16 * q_m, true);
  EXPECT_TRUE(motion.seen()) << "62 counts from where it rested";
}

// A mass under random forces, with friction anywhere above what is told, held whenever it rests: whatever its drive
// does, what it does of it is never called motion without force, one count aside.
TEST(MotionWithoutForce, NeverDoubtsAMassThatOnlyItsDriveMoves) {
  constexpr double mass_kg = 1, lower_N = 2.5, step_s = 1e-3, q_m = 1e-6;
  std::mt19937_64 random{7};
  std::uniform_real_distribution<> unit{0, 1};
  MotionWithoutForce<double> motion{{lower_N, q_m * 1.001}, q_m};
  double x_m = 0, v_m_s = 0, force_N = 0, shown = 0;
  int periods_held = 0;
  for (int period = 0; period < 200'000; ++period) {
    if (random() % 30 == 0) force_N = (unit(random) - 0.5) * (random() % 2 == 0 ? 100 : 8);
    const bool holds = !(v_m_s < 0 || v_m_s > 0) && std::abs(force_N) <= lower_N;
    periods_held += holds;
    motion.force(force_N);
    const double friction_N = lower_N * (1 + unit(random));
    constexpr int parts = 20;
    for (int i = 0; i < parts; ++i) {
      const double free_m_s = v_m_s + force_N / mass_kg * step_s / parts;
      const double braked_m_s = friction_N / mass_kg * step_s / parts;
      v_m_s = std::abs(free_m_s) <= braked_m_s ? 0 : free_m_s - std::copysign(braked_m_s, free_m_s);
      x_m += v_m_s * step_s / parts;
    }
    const double before = std::exchange(shown, std::round(x_m / q_m));
    motion.sample(q_m * (shown - before), holds);
    ASSERT_FALSE(motion.seen()) << "in period " << period;
  }
  EXPECT_GT(periods_held, 1000);
}

}  // namespace
}  // namespace breakaway::firmware
