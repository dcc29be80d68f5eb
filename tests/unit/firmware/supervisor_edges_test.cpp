// The edges of what a supervisor watches: ties, the first sample, both signs, and what a reset and a start forget.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "breakaway/firmware/supervisor.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using Feedback = hal::DriveFeedback<float>;

// A supervisor, and samples of an enabled drive at 1 kHz.
struct Watched {
  Supervisor<float> supervisor;
  hal::Time now{};

  explicit Watched(const AxisLimits<float>& limits, const AxisModel<float>& model = {}) : supervisor{limits, model} {
    supervisor.begin_motion(0);
    supervisor.begin_commands();
  }
  Feedback sample() {
    now += 1ms;
    Feedback f;
    f.state = hal::DriveState::enabled;
    f.sample_time = now;
    f.fresh = f.ever_valid = true;
    return f;
  }
  AxisFault see(const Feedback& f, const AxisHealth& health = {}) { return supervisor.check(f, health, now); }
  AxisFault at(float position_m) {
    Feedback f = sample();
    f.position_m = position_m;
    return see(f);
  }
  AxisFault off_by(float error_m) {
    Feedback f = sample();
    f.position_offset_m = error_m;
    return see(f);
  }
  AxisFault under(float force_N) {
    Feedback f = sample();
    f.force_N = force_N;
    return see(f);
  }
  // Samples until a fault, the one that brings it included; `most` where there is none.
  int samples_until_fault(float force_N, int most) {
    for (int n = 1; n <= most; ++n) {
      if (under(force_N) != AxisFault::none) return n;
    }
    return most;
  }
};

AxisLimits<float> no_limits() { return {.feedback_timeout = 2500us}; }

TEST(SupervisorEdges, AnAxisMayBeAtItsLimitsAndNotBeyond) {
  constexpr float epsilon = std::numeric_limits<float>::epsilon();
  for (const float sign : {1.0F, -1.0F}) {
    AxisLimits<float> limits = no_limits();
    limits.position_min_m = -1;
    limits.position_max_m = 1;
    Watched position{limits};
    EXPECT_EQ(position.at(sign), AxisFault::none);
    EXPECT_EQ(position.at(sign * (1 + epsilon)), AxisFault::position_limit);
    limits = no_limits();
    limits.following_error_m = 0.125F;
    Watched error{limits};
    error.supervisor.begin_motion(sign * 0.5F);
    EXPECT_EQ(error.off_by(sign * 0.625F), AxisFault::none);
    EXPECT_EQ(error.off_by(-sign * 0.625F), AxisFault::none);
    EXPECT_EQ(error.off_by(sign * 0.6250001F), AxisFault::following_error);
    limits = no_limits();
    limits.force_N = 1;
    Watched force{limits};
    EXPECT_EQ(force.under(sign * (1 + 8 * epsilon)), AxisFault::none) << "whole steps of force are rounded";
    EXPECT_EQ(force.under(sign * (1 + 9 * epsilon)), AxisFault::force_limit);
  }
}

TEST(SupervisorEdges, TheFirstSampleHasNoSpeed) {
  AxisLimits<float> limits = no_limits();
  limits.speed_m_s = 2;
  Watched axis{limits};
  Feedback jumped = axis.sample();
  jumped.travel_m = 0.9F;
  EXPECT_EQ(axis.see(jumped), AxisFault::none);
  axis.supervisor.reset();
  jumped = axis.sample();
  jumped.travel_m = -0.9F;
  EXPECT_EQ(axis.see(jumped), AxisFault::none) << "the first one after a reset";
  jumped = axis.sample();
  jumped.travel_m = -0.9F;
  EXPECT_EQ(axis.see(jumped), AxisFault::speed_limit);
}

// Of a SYNC that came late one sample seems faster, and the next one slower; under jitter several in a row may.
TEST(SupervisorEdges, TheSpeedLimitIsExceededByHalfAPeriodsWayOverAnyNumberOfPeriods) {
  AxisLimits<float> limits = no_limits();
  limits.speed_m_s = 2;
  for (const float sign : {1.0F, -1.0F}) {
    Watched axis{limits};
    const auto moved = [&](float travel_m) {
      Feedback f = axis.sample();
      f.travel_m = sign * travel_m;
      return axis.see(f);
    };
    moved(0);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(moved(0.00295F), AxisFault::none) << "late";
      EXPECT_EQ(moved(0.00105F), AxisFault::none) << "and not so late";
    }
    for (int i = 0; i < 3; ++i) {
      for (int late = 0; late < 4; ++late) EXPECT_EQ(moved(0.00224F), AxisFault::none) << "later and later";
      EXPECT_EQ(moved(0.00104F), AxisFault::none) << "and on time again";
    }
    for (int i = 0; i < 9; ++i) EXPECT_EQ(moved(0.0021F), AxisFault::none) << i;
    moved(0.0021F);
    EXPECT_EQ(moved(0.0021F), AxisFault::speed_limit) << "a twentieth too fast";
    axis.supervisor.reset();
    moved(0);
    EXPECT_EQ(moved(0.00301F), AxisFault::speed_limit) << "half as much again";
    axis.supervisor.reset();
    EXPECT_EQ(moved(0.00299F), AxisFault::none) << "the first sample after a reset has none before it";
    EXPECT_EQ(moved(0.00299F), AxisFault::none) << "and what came before the reset does not count";
    EXPECT_EQ(moved(0.00299F), AxisFault::speed_limit);
  }
}

Watched slow_behind_a_coarse_encoder() {
  AxisLimits<float> limits = no_limits();
  limits.speed_m_s = 0.001F;
  AxisModel<float> model;
  model.unseen_m = 1e-5F;
  return Watched{limits, model};
}

// At 1 um a period a reading of 10 um is the next count, and nothing is known of the time in between.
TEST(SupervisorEdges, ASlowAxisBehindACoarseEncoderKeepsItsSpeedLimit) {
  Watched axis = slow_behind_a_coarse_encoder();
  const auto runs_at = [&](int periods_of_a_count, int counts) {
    AxisFault fault = AxisFault::none;
    for (int i = 1; i <= periods_of_a_count * counts && fault == AxisFault::none; ++i) {
      Feedback f = axis.sample();
      f.travel_m = i % periods_of_a_count == 0 ? 1e-5F : 0;
      fault = axis.see(f);
    }
    return fault;
  };
  EXPECT_EQ(runs_at(11, 1000), AxisFault::none) << "nine tenths of its limit";
  EXPECT_EQ(runs_at(9, 30), AxisFault::speed_limit) << "a ninth too fast";
}

TEST(SupervisorEdges, NoiseToAndFroIsNoSpeed) {
  Watched axis = slow_behind_a_coarse_encoder();
  for (int i = 0; i < 1000; ++i) {
    Feedback f = axis.sample();
    f.travel_m = i % 2 == 0 ? 9e-6F : -9e-6F;
    ASSERT_EQ(axis.see(f), AxisFault::none) << i;
  }
}

TEST(SupervisorEdges, ASampleMayBeAsOldAsTheTimeout) {
  Watched axis{no_limits()};
  Feedback old = axis.sample();
  EXPECT_EQ(axis.see(old), AxisFault::none);
  old.fresh = false;
  axis.now = old.sample_time + 2500us;
  EXPECT_EQ(axis.see(old), AxisFault::none);
  axis.now += 1ns;
  EXPECT_EQ(axis.see(old), AxisFault::feedback_stale);
}

// A frame that came late has its own time, and the sample after it that of a SYNC, which may have been before.
TEST(SupervisorEdges, AnAxisThatRestsKeepsItsSpeedLimitWhereTheTimesOfSamplesCross) {
  AxisLimits<float> limits = no_limits();
  limits.speed_m_s = 3;
  Watched axis{limits, {.unseen_m = 1e-6F}};
  for (const hal::Duration late : {0us, 50us, 0us, 900us, -1000us, 0us}) {
    Feedback f = axis.sample();
    f.sample_time += late;
    EXPECT_EQ(axis.see(f), AxisFault::none) << late.count();
  }
}

TEST(SupervisorEdges, AnAxisHasAMinuteToComeNearerOrWhatItsLimitsGive) {
  AxisLimits<float> slow = no_limits();
  slow.progress_timeout = 5min;
  for (const auto& [limits, timeout] : {std::pair{no_limits(), hal::Duration{60s}}, {slow, 5min}}) {
    Watched axis{limits};
    const auto stands_at = [&](hal::Time time) {
      Feedback f = axis.sample();
      axis.now = f.sample_time = time;
      f.position_offset_m = 1;
      return axis.see(f, {.on_its_way = true});
    };
    EXPECT_EQ(stands_at(axis.now + 1ms), AxisFault::none);
    const hal::Time begin = axis.now;
    EXPECT_EQ(stands_at(begin + timeout), AxisFault::none);
    EXPECT_EQ(stands_at(begin + timeout + 1ns), AxisFault::target_not_reached);
  }
  Watched nobody_says{no_limits()};
  EXPECT_EQ(nobody_says.off_by(1), AxisFault::none);
  nobody_says.now += 61s;
  EXPECT_EQ(nobody_says.off_by(1), AxisFault::none) << "unless told an axis is not on its way";
}

// Pushed out of a hold, or done with waiting for others, it has the whole minute, and need not be nearer than it was.
TEST(SupervisorEdges, AnAxisThatHeldHasAMinuteHoweverLongItHeld) {
  Watched axis{no_limits()};
  const auto at = [&](hal::Duration later, float error_m, bool on_its_way) {
    Feedback f = axis.sample();
    axis.now = f.sample_time = axis.now + later;
    f.position_offset_m = error_m;
    return axis.see(f, {.on_its_way = on_its_way});
  };
  EXPECT_EQ(at(1ms, 1e-6F, true), AxisFault::none);
  for (int k = 0; k < 1000; ++k) EXPECT_EQ(at(100ms, 1e-6F, false), AxisFault::none);
  EXPECT_EQ(at(1ms, 1e-3F, true), AxisFault::none) << "pushed";
  for (int second = 0; second < 59; ++second) EXPECT_EQ(at(1s, 1e-3F, true), AxisFault::none) << second;
  EXPECT_EQ(at(1s, 0.9e-3F, true), AxisFault::none) << "nearer";
  EXPECT_EQ(at(59s + 990ms, 0.9e-3F, true), AxisFault::none);
  EXPECT_EQ(at(20ms, 0.9e-3F, true), AxisFault::target_not_reached);
}

// Noise leads such an axis into its hold and out of it again.
TEST(SupervisorEdges, AnAxisThatHoldsForMomentsOnlyComesNoNearer) {
  Watched axis{no_limits()};
  const auto at = [&](bool on_its_way) {
    Feedback f = axis.sample();
    f.position_offset_m = on_its_way ? 1e-3F : 0.9e-3F;
    return axis.see(f, {.on_its_way = on_its_way});
  };
  hal::Time begin = axis.now;
  while (at(true) == AxisFault::none && axis.now < begin + 100s)
    for (int k = 0; k < 900; ++k) ASSERT_EQ(at(false), AxisFault::none);
  EXPECT_EQ(axis.supervisor.fault(), AxisFault::target_not_reached);
  EXPECT_LT(axis.now, begin + 62s);
}

// What ran long ago, or nothing since the clock began, says nothing of the minute; nor does a lost sample.
TEST(SupervisorEdges, AnAxisThatWasOffHasAMinuteFromItsFirstSampleOn) {
  for (const hal::Duration off : {59s, 61s, 1000s}) {
    Watched axis{no_limits()};
    axis.now += off;
    axis.supervisor.begin_motion(1e-3F);
    axis.supervisor.begin_commands();
    Feedback lost = axis.sample();
    lost.fresh = false;
    lost.position_offset_m = 1e-3F;
    EXPECT_EQ(axis.see(lost, {.on_its_way = true}), AxisFault::none) << off.count();
    Feedback first = axis.sample();
    first.position_offset_m = 1e-3F;
    EXPECT_EQ(axis.see(first, {.on_its_way = true}), AxisFault::none) << off.count();
    EXPECT_EQ(axis.see(lost, {.on_its_way = true}), AxisFault::none) << off.count();
  }
}

// The weight is borne by a holding brake while the axis is off, and by the feedforward once it runs.
TEST(SupervisorEdges, WhatAForceBesideTheDriveDidWhileTheAxisWasOffIsNotMissed) {
  const AxisModel<float> model{.mass_kg = 200, .breakaway_N = 31, .feedforward_N = 60, .encoder_resolution_m = 1e-5F};
  for (const hal::Duration off : {300ms, 100'000ms}) {
    Watched axis{no_limits(), model};
    const auto at_rest_under = [&](float force_N) {
      axis.supervisor.command(force_N);
      Feedback f = axis.sample();
      f.force_N = force_N;
      return axis.see(f);
    };
    for (int k = 0; k < 50; ++k) ASSERT_EQ(at_rest_under(60), AxisFault::none) << k;
    axis.now += off;
    axis.supervisor.begin_motion(0);
    axis.supervisor.begin_commands();
    EXPECT_EQ(at_rest_under(0), AxisFault::none);
    for (int k = 0; k < 9; ++k) EXPECT_EQ(at_rest_under(25), AxisFault::none) << k << " after " << off.count();
  }
}

TEST(SupervisorEdges, TellsTheCodeThatBelongsToTheFault) {
  Watched axis{no_limits()};
  EXPECT_EQ(axis.supervisor.fault_code(), 0);
  Feedback bad = axis.sample();
  bad.state = hal::DriveState::fault;
  bad.fault_code = 0x7305;
  EXPECT_EQ(axis.see(bad), AxisFault::drive_fault);
  EXPECT_EQ(axis.supervisor.fault_code(), 0x7305);
  axis.supervisor.reset();
  EXPECT_EQ(axis.supervisor.fault_code(), 0);
  for (const AxisHealth& health : {AxisHealth{.heartbeat_lost = true}, AxisHealth{.bus_off = true}}) {
    axis.supervisor.reset();
    axis.supervisor.check_idle(health, axis.now);
    EXPECT_NE(axis.supervisor.fault(), AxisFault::none);
    EXPECT_EQ(axis.supervisor.fault_code(), 0);
  }
}

TEST(SupervisorEdges, NamesALawThatGotNotANumber) {
  Watched axis{no_limits()};
  EXPECT_EQ(axis.see(axis.sample(), {.control_fault = law::ControlFault::not_a_number}), AxisFault::not_a_number);
  EXPECT_EQ(to_string(AxisFault::none), "none");
}

TEST(SupervisorEdges, AResetForgetsWhereAndHowFarTheAxisMightBe) {
  AxisLimits<float> limits = no_limits();
  limits.position_min_m = -0.5F;
  limits.position_max_m = 0.5F;
  limits.following_error_m = 0.1F;
  for (const float sign : {1.0F, -1.0F}) {
    Watched axis{limits};
    axis.supervisor.begin_commands(sign * 1.5F);
    axis.supervisor.reset();
    EXPECT_EQ(axis.at(sign * 0.9F), AxisFault::position_limit);
    axis.supervisor.reset();
    EXPECT_EQ(axis.off_by(sign * 0.3F), AxisFault::none) << "no motion has begun";
  }
}

TEST(SupervisorEdges, AForceThatIsReportedAsCommandedHasNoName) {
  for (const float sign : {1.0F, -1.0F}) {
    Watched axis{no_limits(), {.max_force_N = 50}};
    for (int n = 0; n < 100; ++n) {
      axis.supervisor.command(sign * 30);
      ASSERT_EQ(axis.under(sign * 30), AxisFault::none);
    }
    for (int n = 0; n < CommandedForce<float>::patience + 2; ++n) {
      axis.supervisor.command(0);
      axis.under(sign * 30);
    }
    EXPECT_EQ(axis.supervisor.fault(), AxisFault::force_not_commanded) << "it is kept";
  }
}

TEST(SupervisorEdges, AStartForgetsTheForceThatWasCommandedBefore) {
  Watched axis{no_limits(), {.max_force_N = 50}};
  for (const float sign : {1.0F, -1.0F}) {
    axis.supervisor.command(sign * 50);
    axis.supervisor.begin_commands();
    EXPECT_EQ(axis.samples_until_fault(sign * 10, 100), CommandedForce<float>::patience);
    EXPECT_EQ(axis.supervisor.fault(), AxisFault::force_not_commanded);
    axis.supervisor.reset();
  }
}

// Under 50 N an axis of 1 kg has gone its twenty counts long before the 10 ms are over.
TEST(SupervisorEdges, CountsTheTimeWithoutMotionFromTheStart) {
  const AxisModel<float> model{.mass_kg = 1, .breakaway_N = 4.5F, .encoder_resolution_m = 1e-6F};
  Watched axis{no_limits(), model};
  EXPECT_EQ(axis.samples_until_fault(-50, 100), 11) << "between the first sample and the second lies the first period";
  EXPECT_EQ(axis.supervisor.fault(), AxisFault::no_motion_under_force);
  Watched again{no_limits(), model};
  EXPECT_EQ(again.samples_until_fault(-50, 8), 8);
  again.supervisor.begin_commands();
  EXPECT_EQ(again.samples_until_fault(-50, 9), 9);
  EXPECT_EQ(again.supervisor.fault(), AxisFault::none) << "another start";
}

TEST(SupervisorEdges, AConstantForceOnTheAxisTakesUpItsShareOfTheDrives) {
  const AxisModel<float> model{.mass_kg = 1, .breakaway_N = 4.5F, .feedforward_N = 10, .encoder_resolution_m = 1e-6F};
  for (const float held_N : {14.0F, 6.0F}) {
    Watched axis{no_limits(), model};
    EXPECT_EQ(axis.samples_until_fault(held_N, 200), 200);
    EXPECT_EQ(axis.supervisor.fault(), AxisFault::none) << held_N;
  }
  for (const float moving_N : {15.5F, 4.5F, -10.0F}) {
    Watched axis{no_limits(), model};
    EXPECT_LT(axis.samples_until_fault(moving_N, 200), 20);
    EXPECT_EQ(axis.supervisor.fault(), AxisFault::no_motion_under_force) << moving_N;
  }
}

TEST(SupervisorEdges, NamesAnAxisThatIsMovedWhileItIsHeld) {
  for (const float sign : {1.0F, -1.0F}) {
    const AxisModel<float> model{
        .feedforward_N = 10, .encoder_resolution_m = 0.0025F, .held = {.force_N = 2, .allowed_m = 0.01F}};
    // Moved by half of what is allowed in each sample.
    const auto moved = [sign](Watched& axis, bool holds, float reported_N) {
      Feedback f = axis.sample();
      f.travel_m = sign * 0.005F;
      f.force_N = reported_N;
      return axis.see(f, {.holds = holds});
    };
    Watched held{no_limits(), model};
    EXPECT_EQ(moved(held, true, 10), AxisFault::none);
    held.supervisor.command(10 + sign * 2);
    EXPECT_EQ(moved(held, false, 10), AxisFault::none);
    EXPECT_EQ(moved(held, false, 10), AxisFault::external_motion);

    Watched commanded{no_limits(), model};
    EXPECT_EQ(moved(commanded, true, 10), AxisFault::none);
    commanded.supervisor.command(10 + sign * 2.1F);
    for (int n = 0; n < 10; ++n) EXPECT_EQ(moved(commanded, false, 10), AxisFault::none) << "it was told to";

    Watched pushed{no_limits(), model};
    EXPECT_EQ(moved(pushed, true, 10), AxisFault::none);
    for (int n = 0; n < 10; ++n)
      EXPECT_EQ(moved(pushed, false, 10 + sign * 2.1F), AxisFault::none) << "a force that is not commanded is another";

    Watched started{no_limits(), model};
    EXPECT_EQ(moved(started, true, 10), AxisFault::none);
    started.supervisor.begin_commands();
    for (int n = 0; n < 10; ++n) EXPECT_EQ(moved(started, false, 10), AxisFault::none) << "it may have been moving";
  }
}

TEST(SupervisorEdges, AnAxisOfWhichNobodySaysThatItIsHeldMayMove) {
  Watched axis{no_limits(), {.encoder_resolution_m = 0.0025F, .held = {.force_N = 2, .allowed_m = 0.01F}}};
  for (int n = 0; n < 10; ++n) {
    Feedback f = axis.sample();
    f.travel_m = 0.005F;
    EXPECT_EQ(axis.see(f, {}), AxisFault::none);
  }
}

// Of an axis whose scale is not told a kilogram and a metre a count are taken: twenty metres, and no more than nothing
// of a constant force.
TEST(SupervisorEdges, AnAxisOfWhichOnlyTheFrictionIsToldIsGivenTheTimeForTwentyMetres) {
  Watched axis{no_limits(), {.breakaway_N = 10}};
  EXPECT_NEAR(axis.samples_until_fault(-50, 5000), 1000, 3);
  EXPECT_EQ(axis.supervisor.fault(), AxisFault::no_motion_under_force);
}

}  // namespace
}  // namespace breakaway::firmware
