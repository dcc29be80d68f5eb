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

// Samples of a drive that seeks its home, one each millisecond.
struct Seeking {
  Supervisor<float> supervisor;
  hal::Time time{};

  explicit Seeking(const AxisModel<float>& model = {})
      : supervisor{AxisLimits<float>{.speed_m_s = 1, .feedback_timeout = 20ms}, model} {}
  AxisFault see(float travel_m, float force_N = 0, bool against_a_stop = false, hal::Duration after = 1ms) {
    time += after;
    Feedback f = homing({}, force_N);
    f.travel_m = travel_m;
    f.sample_time = time;
    supervisor.check_homing(f, {}, time, against_a_stop);
    return supervisor.fault();
  }
};

TEST(HomingWatch, ThreeSamplesInARowThatAreTooFastAreTheSpeedLimit) {
  for (const float sign : {1.0F, -1.0F}) {
    Seeking drive;
    EXPECT_EQ(drive.see(sign), AxisFault::none) << "the first has none before it";
    for (int round = 0; round < 3; ++round) {
      EXPECT_EQ(drive.see(sign * 0.0011F), AxisFault::none);
      EXPECT_EQ(drive.see(sign * 0.0011F), AxisFault::none) << "the place may jump where it is found";
      EXPECT_EQ(drive.see(sign * 0.0009F), AxisFault::none);
    }
    drive.see(sign * 0.0011F);
    drive.see(sign * 0.0011F);
    EXPECT_EQ(drive.see(sign * 0.0011F), AxisFault::speed_limit);
    EXPECT_EQ(drive.supervisor.fault_code(), 0) << "no drive told of it";
  }
}

// A drive that was running, looks for its zero and runs again: samples of one count nothing for the other.
TEST(HomingWatch, CountsTheSamplesThatAreTooFastApartFromThoseOfARun) {
  Seeking drive;
  const auto run = [&drive](float travel_m) {
    Feedback f;
    f.state = hal::DriveState::enabled;
    f.sample_time = drive.time += 1ms;
    f.travel_m = travel_m;
    f.fresh = f.ever_valid = true;
    return drive.supervisor.check(f, {}, drive.time);
  };
  EXPECT_EQ(run(0), AxisFault::none);
  EXPECT_EQ(drive.see(0.0011F), AxisFault::none);
  EXPECT_EQ(drive.see(0.0011F), AxisFault::none) << "the second of three that name it";
  EXPECT_EQ(drive.see(0.0009F), AxisFault::none);
  Seeking found;
  EXPECT_EQ(found.see(0), AxisFault::none);
  drive = found;
  EXPECT_EQ(run(0.0013F), AxisFault::none) << "the first of the two that name it";
  EXPECT_EQ(run(0.0013F), AxisFault::speed_limit);
}

TEST(HomingWatch, SamplesBeforeAGapDoNotCount) {
  Seeking drive;
  drive.see(0);
  drive.see(0.0011F);
  drive.see(0.0011F);
  EXPECT_EQ(drive.see(1, 0, false, 20ms + 1ns), AxisFault::none) << "a speed over a gap says nothing";
  EXPECT_EQ(drive.see(0.0011F), AxisFault::none);
  EXPECT_EQ(drive.see(0.0011F), AxisFault::none);
  EXPECT_EQ(drive.see(0.03F, 0, false, 20ms), AxisFault::speed_limit) << "as long as the timeout is no gap";
}

TEST(HomingWatch, AnAxisThatDoesNotMoveUnderForceIsNamedUnlessItStandsAgainstAStop) {
  const AxisModel<float> model{
      .max_force_N = 50, .mass_kg = 1, .breakaway_N = 5, .feedforward_N = 10, .encoder_resolution_m = 1e-6F};
  const auto after = [&](float force_N, bool against_a_stop, bool gap) {
    Seeking drive{model};
    for (int n = 0; n < 20; ++n) drive.see(0, force_N, against_a_stop, gap && n == 8 ? hal::Duration{21ms} : 1ms);
    return drive.supervisor.fault();
  };
  EXPECT_EQ(after(40, false, false), AxisFault::no_motion_under_force);
  EXPECT_EQ(after(-40, false, false), AxisFault::no_motion_under_force);
  EXPECT_EQ(after(40, true, false), AxisFault::none);
  EXPECT_EQ(after(14, false, false), AxisFault::none) << "feedforward holds most of it";
  EXPECT_EQ(after(-4, false, false), AxisFault::no_motion_under_force) << "and pushes with this one";
  Seeking drive{model};
  for (int n = 0; n < 9; ++n) EXPECT_EQ(drive.see(0, 40), AxisFault::none);
  drive.see(0, 40, false, 21ms);
  for (int n = 0; n < 8; ++n) EXPECT_EQ(drive.see(0, 40), AxisFault::none) << "counted anew after a gap: " << n;
  for (int n = 0; n < 4; ++n) drive.see(0, 40);
  EXPECT_EQ(drive.supervisor.fault(), AxisFault::no_motion_under_force);
  EXPECT_EQ(drive.supervisor.fault_code(), 0) << "no drive told of it";

  Supervisor<float> untold{AxisLimits<float>{.feedback_timeout = 20ms}, model};
  for (hal::Time time{1ms}; time < hal::Time{20ms}; time += 1ms) {
    Feedback f = homing({}, 40);
    f.travel_m = 0;
    f.sample_time = time;
    untold.check_homing(f, {}, time);
  }
  EXPECT_EQ(untold.fault(), AxisFault::no_motion_under_force) << "unless told a drive looks for no stop";
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

TEST_F(ControlLoopTest, NamesTheErrorThatADriveToldOfWhenItFoundNoZero) {
  for (const std::uint16_t code : {std::uint16_t{0x8611}, std::uint16_t{0}}) {
    loop.request_enable(axis);
    probe.feedback = {.state = hal::DriveState::disabled, .homing_failed = true};
    probe.new_error = code;
    step();
    EXPECT_EQ(loop.status(axis).fault, code != 0 ? AxisFault::emergency : AxisFault::homing_failed);
    EXPECT_EQ(loop.supervisor(axis).fault_code(), code);
    probe.feedback.homing_failed = false;
    EXPECT_TRUE(loop.reset_fault(axis));
  }
  loop.request_stop(axis);
  probe.feedback.homing_failed = true;
  probe.new_error = 0x8611;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::homing_failed) << "nobody wants the axis";
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0);
}

TEST_F(ControlLoopTest, NamesTheErrorThatADriveToldOfWhenItWasJustEnabled) {
  loop.request_enable(axis);
  probe.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
  probe.new_error = 0x2310;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::emergency);
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0x2310);
  EXPECT_TRUE(probe.commands.empty()) << "it got no force before";
}

// A law of a mass of 1 kg, whose friction is told.
struct LawOfAMass : testing::ProportionalLaw {
  struct Told {
    float mass_kg = 1;
    struct {
      float upper_N = 5;
    } friction;
    float feedforward_N = 0, encoder_resolution_m = 1e-6F;
  };
  static Told parameters() noexcept { return {}; }
};

template <bool against_a_stop>
struct SeekingDrive : testing::FakeDrive {
  using FakeDrive::FakeDrive;
  static bool homes_against_a_stop() noexcept { return against_a_stop; }
};

// Its axis does not move under 40 N for as long.
template <class Drive>
AxisFault fault_of_a_standing_search() {
  testing::FakePort port;
  testing::DriveProbe probe;
  ControlLoop<testing::FakePort, Drive, LawOfAMass, float> loop{port,
                                                                {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
  const auto axis = *loop.add_axis({&probe, 1}, {}, testing::moderate_limits()).id;
  loop.request_enable(axis);
  probe.feedback = {.state = hal::DriveState::homing, .force_N = 40, .fresh = true, .ever_valid = true};
  for (hal::Time time{1ms}; time < hal::Time{30ms}; time += 1ms) {
    probe.feedback.sample_time = time;
    loop.step(time);
  }
  return loop.status(axis).fault;
}

TEST(HomingWatch, ALoopTakesADriveThatLooksForAStopForNoOtherOne) {
  EXPECT_EQ(fault_of_a_standing_search<SeekingDrive<true>>(), AxisFault::none);
  EXPECT_EQ(fault_of_a_standing_search<SeekingDrive<false>>(), AxisFault::no_motion_under_force);
  EXPECT_EQ(fault_of_a_standing_search<testing::FakeDrive>(), AxisFault::no_motion_under_force) << "it does not say";
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
