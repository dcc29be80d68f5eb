// What is watched while a drive finds its zero by itself, and the fault that a controller starts with.
#include <gtest/gtest.h>

#include <limits>

#include "breakaway/firmware/control_loop.hpp"
#include "control_loop_fixture.hpp"
#include "fake_axis.hpp"

namespace breakaway::firmware::homing_watch {
namespace {

using namespace std::chrono_literals;
using testing::ControlLoopTest;
using Feedback = hal::DriveFeedback<float>;

struct Homing {
  const char* label;
  Feedback feedback;
  AxisHealth health;
  AxisFault fault;
  std::uint16_t code = 0;
};

constexpr hal::Time now{5s};

Feedback homing(hal::Duration age, float force_N) {
  Feedback f;
  f.state = hal::DriveState::homing;
  f.sample_time = now - age;
  f.force_N = force_N;
  f.position_m = f.position_offset_m = f.travel_m = 1e6F;  // it jumps, which is no fault
  f.fresh = f.ever_valid = true;
  return f;
}

TEST(HomingWatch, NamesWhatGoesWrongAndMindsNoJumpOfThePosition) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  AxisLimits<float> limits{.position_min_m = -1, .position_max_m = 1, .speed_m_s = 1, .force_N = 20};
  limits.following_error_m = 0.1F;
  limits.feedback_timeout = 2500us;
  const Feedback good = homing(1ms, 0);
  for (const Homing& row :
       {Homing{"nothing", good, {}, AxisFault::none},
        Homing{"as old as it may be", homing(2500us, 0), {}, AxisFault::none},
        Homing{"older", homing(2500us + 1ns, 0), {}, AxisFault::feedback_stale},
        Homing{"from after the step began", homing(-1ms, 0), {}, AxisFault::none},
        Homing{"all the force that it may have", homing(1ms, 20), {}, AxisFault::none},
        Homing{"the other way", homing(1ms, -20), {}, AxisFault::none},
        Homing{"more", homing(1ms, 20.001F), {}, AxisFault::force_limit},
        Homing{"more the other way", homing(1ms, -20.001F), {}, AxisFault::force_limit},
        Homing{"no number", homing(1ms, nan), {}, AxisFault::force_limit},
        Homing{"emergency", good, {.emergency_code = 0x8611}, AxisFault::emergency, 0x8611},
        Homing{"emergency 1", good, {.emergency_code = 1}, AxisFault::emergency, 1},
        Homing{"bus off", good, {.bus_off = true}, AxisFault::bus_off},
        Homing{"heartbeat", good, {.heartbeat_lost = true}, AxisFault::heartbeat_lost},
        Homing{"the first counts", homing(1s, 99), {.heartbeat_lost = true}, AxisFault::heartbeat_lost}}) {
    Supervisor<float> supervisor{limits};
    supervisor.check_homing(row.feedback, row.health, now);
    EXPECT_EQ(supervisor.fault(), row.fault) << row.label;
    EXPECT_EQ(supervisor.fault_code(), row.code) << row.label;
  }
  // The limit of force holds for whole steps, which are rounded.
  limits.force_N = 1;
  for (const float sign : {1.0F, -1.0F}) {
    constexpr float epsilon = std::numeric_limits<float>::epsilon();
    Supervisor<float> supervisor{limits};
    supervisor.check_homing(homing(1ms, sign * (1 + 8 * epsilon)), {}, now);
    EXPECT_EQ(supervisor.fault(), AxisFault::none);
    supervisor.check_homing(homing(1ms, sign * (1 + 9 * epsilon)), {}, now);
    EXPECT_EQ(supervisor.fault(), AxisFault::force_limit);
  }
}

TEST_F(ControlLoopTest, WatchesADriveThatFindsItsZeroWhereItIsWanted) {
  probe.feedback = {.state = hal::DriveState::homing, .fresh = true, .ever_valid = true};
  probe.new_error = 0x8611;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "nobody wants the axis";
  loop.request_enable(axis);
  run_for(30s);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "the drive has a time limit of its own";
  probe.new_error = 0x8611;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::emergency);
  EXPECT_GE(probe.stops, 1);
}

TEST_F(ControlLoopTest, AnOldSampleOfADriveThatIsNotEnabledYetIsNoFault) {
  loop.request_enable(axis);
  for (const hal::DriveState state :
       {hal::DriveState::configuring, hal::DriveState::disabled, hal::DriveState::enabling}) {
    probe.feedback = {.state = state, .ever_valid = true};
    probe.new_error = 0x8130;
    loop.step(now += 1s);
    EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  }
}

TEST_F(ControlLoopTest, NamesADriveThatFoundNoZeroWantedOrNot) {
  probe.feedback = {.state = hal::DriveState::disabled, .homing_failed = true};
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::homing_failed);
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0);
  probe.feedback.homing_failed = false;
  EXPECT_TRUE(loop.reset_fault(axis));
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
}

TEST_F(ControlLoopTest, StartsWithTheFaultThatEndedItsLastRunAndStaysDisabled) {
  loop.request_enable(axis);
  loop.start_with(axis, AxisFault::watchdog_reset, now);
  EXPECT_EQ(probe.stops, 1);
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0);
  probe.feedback = {.state = hal::DriveState::disabled, .fresh = true, .ever_valid = true};
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::watchdog_reset);
  EXPECT_TRUE(loop.reset_fault(axis));
  run_for(100ms);
  EXPECT_EQ(probe.enables, 0) << "the wish of before counts no more";
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
}

TEST(HomingWatch, AForceThatFallsShortIsNamedEitherWay) {
  for (const float sign : {1.0F, -1.0F}) {
    Supervisor<float> supervisor{AxisLimits<float>{.feedback_timeout = 1s}, {.max_force_N = 50}};
    supervisor.begin_commands();
    hal::Time time{};
    for (int n = 0; n < 300 && supervisor.fault() == AxisFault::none; ++n) {
      time += 1ms;
      Feedback f;
      f.state = hal::DriveState::enabled;
      f.sample_time = time;
      f.force_N = n < 100 ? sign * 40 : sign * 20;
      f.fresh = f.ever_valid = true;
      supervisor.command(sign * 40);
      supervisor.check(f, {}, time);
      if (n == 100) {
        EXPECT_EQ(supervisor.fault(), AxisFault::none);
      }
    }
    EXPECT_EQ(supervisor.fault(), AxisFault::less_force_than_commanded);
  }
}

}  // namespace
}  // namespace breakaway::firmware::homing_watch
