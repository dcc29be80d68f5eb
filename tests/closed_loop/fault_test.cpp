// Whatever goes wrong, the force is zero within two periods, the fault has a name and stays, and an explicit reset
// recovers.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;

struct Failure {
  const char* label;
  AxisFault expected;
  std::function<void(Rig&)> inject;
  std::function<void(Rig&)> mend;
};

class AfterFailure : public ::testing::TestWithParam<Failure> {};

TEST_P(AfterFailure, ForceIsZeroWithinTwoPeriodsAndResetRecovers) {
  const Failure& failure = GetParam();
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  ASSERT_GT(rig.force_N(0), 10);
  failure.inject(rig);
  steps_until_fault(rig, 400);
  ASSERT_EQ(rig.status(0).fault, failure.expected) << to_string(rig.status(0).fault);
  rig.run(2ms);
  // The current loop needs a few of its time constants of 0.1 ms to come down from 50 N.
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << "two periods after the step that saw it";
  EXPECT_LT(rig.largest_force_N(0, 300ms), 0.1) << "latched";
  EXPECT_EQ(rig.status(0).fault, failure.expected) << "and named as before";

  failure.mend(rig);
  rig.run(2500ms);  // a drive that was set back has to be set up again
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << "no motion without a reset";
  rig.loop().reset_fault(rig.id(0));
  rig.run(5s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

const auto nothing = [](Rig&) {};

INSTANTIATE_TEST_SUITE_P(Kinds, AfterFailure,
                         ::testing::Values(Failure{"DriveTrips", AxisFault::emergency,
                                                   [](Rig& rig) { rig.drive(0).trip_fault(0x2310, rig.now()); },
                                                   nothing},
                                           Failure{"DriveFallsSilent", AxisFault::feedback_stale,
                                                   [](Rig& rig) { rig.drive(0).set_silent(true); },
                                                   [](Rig& rig) { rig.drive(0).set_silent(false); }},
                                           Failure{"CableIsPulledAndTheDriveRebootsUnheard", AxisFault::feedback_stale,
                                                   [](Rig& rig) { rig.drive(0).set_silent(true); },
                                                   [](Rig& rig) {
                                                     rig.drive(0).power_off(rig.now());
                                                     rig.drive(0).power_on(rig.now());
                                                     rig.run(20ms);
                                                     rig.drive(0).set_silent(false);
                                                   }},
                                           Failure{"HeartbeatStops", AxisFault::heartbeat_lost,
                                                   [](Rig& rig) { rig.drive(0).suppress_heartbeat(true); },
                                                   [](Rig& rig) { rig.drive(0).suppress_heartbeat(false); }},
                                           Failure{"DriveReboots", AxisFault::feedback_stale,
                                                   [](Rig& rig) {
                                                     rig.drive(0).power_off(rig.now());
                                                     rig.drive(0).power_on(rig.now());
                                                   },
                                                   nothing}),
                         [](const auto& param_info) { return std::string{param_info.param.label}; });

struct Disobedience {
  const char* label;
  std::function<void(Rig&)> tamper;
  std::function<void(Rig&)> mend;
};

class AStopThatIsNotObeyed : public ::testing::TestWithParam<Disobedience> {};

TEST_P(AStopThatIsNotObeyed, IsForcedNamedAndResetOnlyThen) {
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  ASSERT_GT(rig.force_N(0), 10);
  GetParam().tamper(rig);
  rig.run(2ms);
  rig.loop().request_stop(rig.id(0));
  rig.run(15ms);
  ASSERT_GT(rig.force_N(0), 10) << "the tampering does not do what it is for";
  rig.run(15ms);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << "30 ms after the stop";
  EXPECT_TRUE(rig.status(0).stop_not_obeyed);
  EXPECT_LT(rig.largest_force_N(0, 500ms), 0.1);
  ASSERT_NE(rig.status(0).fault, AxisFault::none);

  GetParam().mend(rig);
  EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.loop().request_enable(rig.id(0));
  rig.run(5s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

INSTANTIATE_TEST_SUITE_P(
    Of, AStopThatIsNotObeyed,
    ::testing::Values(Disobedience{"ADriveWhoseRpdoWasSwitchedOff",  // its set-up is mended by being done anew
                                   [](Rig& rig) { rig.write_to_drive(0x1400, 1, 0x80000201, 4); }, nothing},
                      Disobedience{"ADriveThatDoesNotHearSync",
                                   [](Rig& rig) { rig.write_to_drive(0x1005, 0, 0x81, 4); },
                                   [](Rig& rig) { rig.write_to_drive(0x1005, 0, 0x80, 4); }}),
    [](const auto& param_info) { return std::string{param_info.param.label}; });

TEST(Fault, ResetIsRefusedWhileTheDriveDoesNotObeyTheStop) {
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.drive(0).set_silent(true);
  rig.run(100ms);
  ASSERT_EQ(rig.status(0).fault, AxisFault::feedback_stale);
  ASSERT_TRUE(rig.status(0).stop_not_obeyed);
  EXPECT_FALSE(rig.loop().reset_fault(rig.id(0)));
  EXPECT_EQ(rig.status(0).fault, AxisFault::feedback_stale);
}

TEST(Fault, ForceThatTheDriveAddsByItselfStopsTheAxisByName) {
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.run(2500ms);  // at the target, where little force is commanded
  ASSERT_LE(std::abs(rig.position_m(0)), 3e-6);
  rig.write_to_drive(0x60B2, 0, 600, 2);
  steps_until_fault(rig, 50);
  EXPECT_EQ(rig.status(0).fault, AxisFault::force_not_commanded) << to_string(rig.status(0).fault);
  rig.run(3ms);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
}

struct Standstill {
  hal::Duration period;
  double lag_s;
  hal::Duration most;  // from the first force until none is left
};

// As firmware/FAULTS.md says.
TEST(Fault, AnAxisThatStandsUnderFullForceIsStoppedInMilliseconds) {
  for (const auto& [period, lag_s, most] :
       {Standstill{500us, 1e-4, 12ms}, Standstill{1ms, 1e-4, 12ms}, Standstill{2ms, 1e-4, 14ms},
        Standstill{1ms, 2e-3, 24ms}, Standstill{2ms, 2e-3, 26ms}}) {
    auto config = far_from_target();
    config.period = period;
    config.current_loop_time_constant_s = lag_s;
    config.friction = model::FrictionLaw{{60, 60}, model::shape::constant(1)};  // it is clamped
    Rig rig{config};
    for (rig.loop().request_enable(rig.id(0)); std::abs(rig.force_N(0)) < 0.1 && rig.now() < hal::Time{5s};) rig.step();
    const hal::Time begin = rig.now();
    while (std::abs(rig.force_N(0)) >= 0.1 && rig.now() < begin + 1s) rig.step();
    EXPECT_EQ(rig.status(0).fault, AxisFault::no_motion_under_force) << to_string(rig.status(0).fault);
    EXPECT_LE(rig.now() - begin, most) << (rig.now() - begin) / 1us << " us at a period of " << period / 1us
                                       << " us and " << lag_s << " s";
    EXPECT_GT(rig.now() - begin, 8ms) << "there was force at all";
  }
}

TEST(Fault, AnAxisThatStandsBeyondALimitOfPositionComesBackAfterAReset) {
  for (const Real sign : {1.0F, -1.0F}) {
    auto config = far_from_target();
    config.start_m = 0.5 * sign;
    config.limits.position_min_m = -0.3F;
    config.limits.position_max_m = 0.3F;
    Rig rig{config};
    ASSERT_TRUE(rig.start());
    rig.run(4s);
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
    EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
    rig.loop().set_target_m(rig.id(0), 0.4F * sign);
    steps_until_fault(rig, 2000);
    EXPECT_EQ(rig.status(0).fault, AxisFault::position_limit) << "and not out again";
    rig.run(3s);
    rig.loop().set_target_m(rig.id(0), 0.45F * sign);
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
    steps_until_fault(rig, 2000);
    EXPECT_EQ(rig.status(0).fault, AxisFault::position_limit) << "nor further";
  }
}

// The reset is said again while the drive is still made to boot.
TEST(Fault, ALostHeartbeatIsNamedOnceAReset) {
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.write_to_drive(0x1017, 0, 0, 2);
  steps_until_fault(rig, 400);
  ASSERT_EQ(rig.status(0).fault, AxisFault::heartbeat_lost);
  rig.run(30ms);
  EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  for (int i = 0; i < 5000; ++i) {
    rig.step();
    ASSERT_EQ(rig.status(0).fault, AxisFault::none) << i << ' ' << to_string(rig.status(0).fault);
  }
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

TEST(Fault, BusOffStopsTheAxisInTheNextStep) {
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.network().controller_port().set_bus_state(hal::BusState::bus_off);
  rig.step();
  EXPECT_EQ(rig.status(0).fault, AxisFault::bus_off);
  rig.run(1s);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << "cut off from its master, the drive stops by itself";
}

TEST(Fault, SpeedLimitStopsTheAxis) {
  auto config = far_from_target();
  config.limits.speed_m_s = 1;
  Rig rig{config};
  ASSERT_TRUE(rig.start());
  steps_until_fault(rig, 1000);
  EXPECT_EQ(rig.status(0).fault, AxisFault::speed_limit);
  rig.run(2ms);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
}

TEST(Fault, PositionLimitStopsTheAxis) {
  auto config = far_from_target();
  config.limits.position_max_m = -0.5F;
  Rig rig{config};
  ASSERT_TRUE(rig.start());
  steps_until_fault(rig, 2000);
  EXPECT_EQ(rig.status(0).fault, AxisFault::position_limit);
}

TEST(Fault, OfOneAxisLeavesTheOthersRunning) {
  Rig rig{{.axes = 2}};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.drive(0).trip_fault(0x4210, rig.now());
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::emergency);
  EXPECT_EQ(rig.status(1).fault, AxisFault::none);
  EXPECT_LE(std::abs(rig.position_m(1)), 3e-6);
}

TEST(Fault, OfOneAxisStopsAllWhereTheNodeSaysSoAndTheyStartTogether) {
  Rig rig{{.axes = 3, .period = 1ms, .fault_scope = firmware::FaultScope::all_axes}};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.drive(1).trip_fault(0x4210, rig.now());
  rig.run(20ms);
  EXPECT_EQ(rig.status(0).fault, AxisFault::stopped_with_another);
  EXPECT_EQ(rig.status(1).fault, AxisFault::emergency);
  EXPECT_EQ(rig.status(2).fault, AxisFault::stopped_with_another);
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_LT(rig.largest_force_N(axis, 100ms), 0.1) << axis;
  for (const std::size_t axis : {2U, 0U}) {
    rig.loop().reset_fault(rig.id(axis));
    rig.run(300ms);
    EXPECT_LT(std::abs(rig.force_N(axis)), 0.1) << "the tripped drive still has its fault";
  }
  rig.loop().reset_fault(rig.id(1));
  rig.run(3s);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(rig.status(axis).fault, AxisFault::none) << to_string(rig.status(axis).fault);
    EXPECT_LE(std::abs(rig.position_m(axis)), 3e-6) << axis;
  }
}

// They leave their drives' PDOs one a period: until it is told so, none misses them, whatever its RPDO timeout.
TEST(Fault, OfAllAxesIsResetInOnePeriod) {
  for (const auto& [axes, period] : {std::pair{2U, 1ms}, {3U, 1ms}, {3U, 10ms}, {4U, 2ms}, {6U, 2ms}}) {
    RigConfig config;
    config.axes = axes;
    config.period = period;
    Rig rig{config};
    ASSERT_TRUE(rig.start()) << axes;
    rig.run(100ms);
    for (std::size_t i = 0; i < axes; ++i) rig.loop().stop_with(rig.id(i), AxisFault::commander_lost, rig.now());
    rig.run(1s);
    for (std::size_t i = 0; i < axes; ++i) rig.loop().reset_fault(rig.id(i));
    for (const hal::Time end = rig.now() + 6s; rig.now() < end;) {
      rig.run(100ms);
      for (std::size_t i = 0; i < axes; ++i)
        ASSERT_EQ(rig.status(i).fault, AxisFault::none)
            << axes << " axes, axis " << i << ": " << to_string(rig.status(i).fault);
    }
  }
}

TEST(Fault, SingleLostFramesDoNotStopTheAxisOrSpoilItsAccuracy) {
  RigConfig config;
  config.bus.loss_probability = 1e-3;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    config.bus.seed = seed;
    Rig rig{config};
    ASSERT_TRUE(rig.start()) << seed;
    rig.run(3s);
    if (rig.status(0).fault == AxisFault::feedback_stale) continue;  // two in a row: a stop is right
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << seed << ' ' << to_string(rig.status(0).fault);
    EXPECT_LE(std::abs(rig.position_m(0)), 3e-6) << seed;
  }
}

}  // namespace
}  // namespace breakaway::closed_loop
