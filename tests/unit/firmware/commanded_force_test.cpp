#include "breakaway/firmware/commanded_force.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace breakaway::firmware {
namespace {

constexpr float max_force_N = 50, step_N = 0.05F;

// Any commands, through a current loop of first order and rounding to a step: never an excess.
TEST(CommandedForce, AllowsEveryCurrentLoopThatIsNoSlowerThanSixteenPeriods) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<float> any{-max_force_N, max_force_N};
  for (const float share : {1.0F, 0.7F, 0.2F, 0.0625F}) {
    CommandedForce<float> force{max_force_N};
    float command_N = 0, answer_N = 0;
    for (int period = 0; period < 20'000; ++period) {
      if (random() % 20 == 0) command_N = random() % 2 == 0 ? 0.0F : any(random);
      force.command(command_N);
      answer_N += share * (command_N - answer_N);
      force.report(step_N * std::round(answer_N / step_N), step_N);
      ASSERT_FALSE(force.exceeded()) << share << " in period " << period;
    }
  }
}

// Pulses of any length, reported up to three periods late: what lies beyond does not last.
TEST(CommandedForce, AllowsReportsThatComeLate) {
  std::mt19937_64 random{11};
  CommandedForce<float> force{max_force_N};
  std::array<float, 4> past{};
  float command_N = 0;
  for (std::size_t period = 0; period < 20'000; ++period) {
    if (random() % 8 == 0) command_N = (random() % 3 == 0 ? -1.0F : 1.0F) * static_cast<float>(random() % 51);
    force.command(command_N);
    past[period % 4] = command_N;
    force.report(past[(period + 1) % 4], step_N);
    ASSERT_FALSE(force.exceeded()) << period;
  }
}

// An approach at its greatest speed may swing to and fro from period to period, as the last digits of a reading have
// it.
TEST(CommandedForce, AllowsCommandsThatSwingToAndFroAndAreReportedAPeriodLate) {
  for (const float least : {-1.0F, -0.6F, 0.0F, 0.5F}) {
    for (const int periods : {1, 2, 3}) {
      CommandedForce<float> force{max_force_N};
      float before_N = 0;
      for (int period = 0; period < 400; ++period) {
        const float command_N = max_force_N * ((period / periods) % 2 == 0 ? 1.0F : least);
        force.command(command_N);
        force.report(before_N, step_N);
        before_N = command_N;
        ASSERT_FALSE(force.exceeded()) << least << " every " << periods << " in period " << period;
      }
    }
  }
}

// The same behind a slow current loop, as the coast "brake" allows it.
TEST(CommandedForce, AllowsReportsOfASlowCurrentLoopThatComeLate) {
  for (const float lag_periods : {0.2F, 4.0F, 16.0F, 20.0F, 100.0F}) {
    std::mt19937_64 random{13};
    const float left = std::exp(-1 / lag_periods);
    CommandedForce<float> force{max_force_N, left};
    std::array<float, 4> past{};
    float command_N = 0, answer_N = 0;
    for (std::size_t period = 0; period < 20'000; ++period) {
      if (random() % 64 == 0) command_N = (random() % 2 == 0 ? -1.0F : 1.0F) * static_cast<float>(random() % 51);
      force.command(command_N);
      answer_N = command_N + (answer_N - command_N) * left;
      past[period % 4] = answer_N;
      force.report(past[(period + 1) % 4], step_N);
      ASSERT_FALSE(force.exceeded()) << lag_periods << " in period " << period;
    }
  }
}

TEST(CommandedForce, SeesAForceThatADriveWithASlowCurrentLoopKeeps) {
  CommandedForce<float> force{max_force_N, 0.99F};
  force.command(50);
  int periods = 0;
  for (; !force.exceeded() && periods < 1000; ++periods) {
    force.command(0);
    force.report(50, step_N);
  }
  EXPECT_EQ(periods, 21)
      << "the border falls by half a percent a period from the second on, and ten samples lie beyond it";
}

TEST(CommandedForce, AllowsLessForceThanCommanded) {
  CommandedForce<float> force{max_force_N};
  for (int period = 0; period < 100; ++period) {
    force.command(max_force_N);
    force.report(3.0F, step_N);
  }
  EXPECT_FALSE(force.exceeded());
}

// A drive that gives a share of every command.
bool falls_short(float share, float command_N) {
  CommandedForce<float> force{max_force_N};
  for (int period = 0; period < 60; ++period) {
    force.command(command_N);
    force.report(share * command_N, step_N);
  }
  return force.fallen_short();
}

TEST(CommandedForce, SeesThatADriveGivesAShareOfWhatItIsTold) {
  for (const float sign : {1.0F, -1.0F}) {
    EXPECT_TRUE(falls_short(0.5F, sign * 12));
    EXPECT_TRUE(falls_short(0.6F, sign * 50));
    EXPECT_FALSE(falls_short(0.8F, sign * 50)) << "a motor may lack some";
    EXPECT_FALSE(falls_short(0.5F, sign * 8)) << "within a twentieth of the limit";
    EXPECT_FALSE(falls_short(0.0F, sign * 50)) << "a drive that reports no force";
  }
}

// Any commands, through any current loop that is no slower than the border, up to three periods late.
TEST(CommandedForce, NoLawfulAnswerFallsShort) {
  for (const float share : {1.0F, 0.3F, 0.0625F}) {
    std::mt19937_64 random{17};
    CommandedForce<float> force{max_force_N};
    std::array<float, 4> past{};
    float command_N = 0, answer_N = 0;
    for (std::size_t period = 0; period < 20'000; ++period) {
      if (random() % 24 == 0) command_N = (random() % 2 == 0 ? -1.0F : 1.0F) * static_cast<float>(random() % 51);
      force.command(command_N);
      answer_N += share * (command_N - answer_N);
      past[period % 4] = answer_N;
      force.report(past[(period + 1) % 4], step_N);
      ASSERT_FALSE(force.fallen_short()) << share << " in period " << period;
    }
  }
}

int periods_until_exceeded(float kept_N, float command_N) {
  CommandedForce<float> force{max_force_N};
  for (int period = 0; period < 50; ++period) {
    force.command(kept_N);
    force.report(kept_N, step_N);
    EXPECT_FALSE(force.exceeded());
  }
  for (int period = 1; period < 1000; ++period) {
    force.command(command_N);
    force.report(kept_N, step_N);
    if (force.exceeded()) return period;
  }
  return 1000;
}

TEST(CommandedForce, SeesAForceThatADriveKeeps) {
  for (const float sign : {1.0F, -1.0F}) {
    EXPECT_LE(periods_until_exceeded(sign * 50, 0), 12);
    EXPECT_LE(periods_until_exceeded(sign * 12.4F, 0), 20);
    EXPECT_LE(periods_until_exceeded(sign * 12.4F, -sign * 50), 13);
    EXPECT_EQ(periods_until_exceeded(sign * 4, 0), 26) << "the border falls by a sixteenth a period from the second on";
    EXPECT_EQ(periods_until_exceeded(sign * 2.5F, 0), 1000) << "within a twentieth of the limit";
  }
}

// Ten samples of this force; whether they are too much.
bool is_exceeded_by(CommandedForce<float>& force, float reported_N) {
  for (int sample = 1; sample < CommandedForce<float>::patience; ++sample) {
    force.report(reported_N, step_N);
    EXPECT_FALSE(force.exceeded()) << "sample " << sample;
  }
  force.report(reported_N, step_N);
  return force.exceeded();
}

TEST(CommandedForce, AtTheStartAndAfterARestartAllowsATwentiethAndAStepOnly) {
  for (const float sign : {1.0F, -1.0F}) {
    CommandedForce<float> fresh{max_force_N}, within{max_force_N}, restarted{max_force_N};
    EXPECT_TRUE(is_exceeded_by(fresh, sign * 2.6F));
    EXPECT_FALSE(is_exceeded_by(within, sign * 2.5F));
    for (const float before_N : {50.0F, -50.0F}) {
      restarted.command(before_N);
      restarted.restart();
      EXPECT_TRUE(is_exceeded_by(restarted, sign * 2.6F));
      restarted.restart();
      EXPECT_FALSE(is_exceeded_by(restarted, sign * 2.5F));
    }
    within.report(sign * 2.5F, step_N);
    EXPECT_TRUE(is_exceeded_by(within, sign * 2.6F)) << "counted from the last sample inside";
  }
}

TEST(CommandedForce, AForceOfOneSignAllowsNoneOfTheOther) {
  for (const float sign : {1.0F, -1.0F}) {
    CommandedForce<float> force{max_force_N};
    force.command(sign * 50);
    EXPECT_FALSE(is_exceeded_by(force, -sign * 2.5F));
    force.restart();
    force.command(sign * 50);
    EXPECT_TRUE(is_exceeded_by(force, -sign * 2.6F));
  }
}

// However long a force is commanded: what a drive does not give does no harm.
TEST(CommandedForce, NoForceIsNeverTooMuch) {
  for (const float side : {1.0F, -1.0F}) {
    CommandedForce<float> force{10};
    for (int period = 0; period < 200; ++period) {
      force.command(side * 5);
      force.report(0, step_N);
      ASSERT_FALSE(force.exceeded()) << period;
    }
  }
}

TEST(CommandedForce, AllowsExactlyATwentiethAndAStep) {
  for (const float sign : {1.0F, -1.0F}) {
    CommandedForce<float> force{40};
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 2.5F, 0.5F);
    EXPECT_FALSE(force.exceeded());
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 2.5001F, 0.5F);
    EXPECT_TRUE(force.exceeded());
  }
}

TEST(CommandedForce, TakesNotANumberForNoForceAndForgetsAtARestart) {
  CommandedForce<float> force{max_force_N};
  for (int period = 0; period < 20; ++period) {
    force.command(std::numeric_limits<float>::quiet_NaN());
    force.report(2.6F, step_N);
  }
  EXPECT_TRUE(force.exceeded());
  force.restart();
  EXPECT_FALSE(force.exceeded());
}

// The first command lays the nearer border at a sixteenth of it.
TEST(CommandedForce, CountsTenShortSamplesInARowFromTheStart) {
  for (const float sign : {1.0F, -1.0F}) {
    CommandedForce<float> force{1};
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 0.3F, 0.05F);
    EXPECT_FALSE(force.fallen_short()) << "nothing is owed yet";
    for (const int before : {0, 9}) {
      force = CommandedForce<float>{1};
      force.command(sign * 16);
      for (int sample = 0; sample < before; ++sample) force.report(sign * 0.3F, 0.05F);
      if (before > 0) force.report(sign * 0.9F, 0.05F);
      for (int sample = 1; sample <= CommandedForce<float>::patience; ++sample) {
        EXPECT_FALSE(force.fallen_short()) << "sample " << sample;
        force.report(sign * 0.3F, 0.05F);
      }
      EXPECT_TRUE(force.fallen_short());
    }
  }
}

// Less force than before counts at once, and more as the border comes nearer.
TEST(CommandedForce, OwesThreeQuartersOfTheLeastOfLateLessTheTolerance) {
  for (const float sign : {1.0F, -1.0F}) {
    CommandedForce<float> force{40};
    for (int period = 0; period < 500; ++period) force.command(sign * 40);
    force.command(sign * 20);
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 12.5F, 0.5F);
    EXPECT_FALSE(force.fallen_short()) << "15 N less 2.5 N";
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 12.4999F, 0.5F);
    EXPECT_TRUE(force.fallen_short());
    force.report(sign * 13, 0.5F);
    force.command(sign * 36);
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 13.25F, 0.5F);
    EXPECT_FALSE(force.fallen_short()) << "of 21 N";
    for (int sample = 0; sample < 20; ++sample) force.report(sign * 13.2499F, 0.5F);
    EXPECT_TRUE(force.fallen_short());
  }
}

TEST(CommandedForce, WatchesNothingWithoutALimit) {
  CommandedForce<float> force{std::numeric_limits<float>::infinity()};
  for (int period = 0; period < 20; ++period) force.report(1e30F, 0);
  EXPECT_FALSE(force.exceeded());
}

}  // namespace
}  // namespace breakaway::firmware
