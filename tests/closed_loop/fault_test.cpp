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

RigConfig far_from_target() {
  RigConfig config;
  config.start_m = -1.0;  // full force for a while
  config.limits.speed_m_s = 20;
  config.limits.position_min_m = -2;
  config.limits.position_max_m = 2;
  return config;
}

// Steps until the loop has seen the fault; the number of steps that took.
int steps_until_fault(Rig& rig, int most) {
  int steps = 0;
  while (rig.status(0).fault == AxisFault::none && steps < most) {
    rig.step();
    ++steps;
  }
  return steps;
}

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

// A reset alone moves nothing, because nobody knows where to.
TEST(Fault, AnIncrementalAxisWhoseDriveRebootedWaitsUntilItIsToldWhereItStands) {
  auto config = far_from_target();
  config.absolute_encoder = false;
  Rig rig{config};
  while (!rig.status(0).feedback.ever_valid) rig.step();
  ASSERT_TRUE(rig.loop().set_reference_counts(rig.id(0), -1'000'000));
  ASSERT_TRUE(rig.start());
  rig.run(4s);
  ASSERT_LE(std::abs(rig.position_m(0)), 4e-6);
  EXPECT_FALSE(rig.loop().set_reference_counts(rig.id(0), 5)) << "it runs";
  rig.drive(0).power_off(rig.now());
  rig.drive(0).power_on(rig.now());
  rig.run(1s);
  ASSERT_NE(rig.status(0).fault, AxisFault::none);
  rig.loop().set_target_m(rig.id(0), 0.1F);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
    EXPECT_LT(rig.largest_force_N(0, 1s), 0.1);
    EXPECT_EQ(rig.status(0).fault, AxisFault::reference_lost) << to_string(rig.status(0).fault);
  }
  EXPECT_TRUE(rig.loop().set_reference_counts(rig.id(0), 0));
  EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.run(4s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), 0.1, 6e-6);
}

struct HomeInFile {
  const char* label;
  cia402::Home home;
};
class AnIncrementalAxisWithAHome : public ::testing::TestWithParam<HomeInFile> {};

// Where it stands is 0.25 m, whatever its drive counts.
TEST_P(AnIncrementalAxisWithAHome, GetsItsZeroAtTheStartAndAfterAResetThatAcknowledgesItsLoss) {
  auto config = far_from_target();
  config.absolute_encoder = false;
  config.homing = {.home = GetParam().home, .position_counts = 250'000};
  Rig rig{config};
  ASSERT_TRUE(rig.start()) << to_string(rig.status(0).fault);
  rig.run(4s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), -1.25, 6e-6);
  rig.drive(0).power_off(rig.now());
  rig.drive(0).power_on(rig.now());
  rig.run(1s);
  ASSERT_NE(rig.status(0).fault, AxisFault::none);
  ASSERT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.run(4s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), -1.5, 1e-5);
  EXPECT_TRUE(rig.status(0).running);
}
INSTANTIATE_TEST_SUITE_P(Homes, AnIncrementalAxisWithAHome,
                         ::testing::Values(HomeInFile{"Here", cia402::Home::here},
                                           HomeInFile{"ByDrive", cia402::Home::by_drive}),
                         [](const auto& param_info) { return std::string{param_info.param.label}; });

TEST(Fault, AHomingThatFailsIsNamedAndTriedAgainAfterAReset) {
  RigConfig config;
  config.absolute_encoder = false;
  config.homing = {.home = cia402::Home::by_drive};
  config.quirks.homing_fails = true;
  Rig rig{config};
  EXPECT_FALSE(rig.start());
  EXPECT_EQ(rig.status(0).fault, AxisFault::homing_failed) << to_string(rig.status(0).fault);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
    rig.run(20ms);
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
    rig.run(1s);
    EXPECT_EQ(rig.status(0).fault, AxisFault::homing_failed) << to_string(rig.status(0).fault);
  }
}

TEST(Fault, AnAxisIsWatchedWhileItsDriveFindsItsHome) {
  RigConfig config;
  config.absolute_encoder = false;
  config.homing = {.home = cia402::Home::by_drive};
  config.quirks.mode_display_delay = 200ms;  // of each mode, so that there is time to interfere
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  const auto homing = [&] { return rig.status(0).feedback.state == hal::DriveState::homing; };
  while (!homing() && rig.now() < hal::Time{5s}) rig.step();
  ASSERT_TRUE(homing());
  rig.run(50ms);
  EXPECT_FALSE(rig.loop().reset_fault(rig.id(0))) << "it may have force";
  rig.drive(0).trip_fault(0x4210, rig.now());
  steps_until_fault(rig, 3);
  EXPECT_EQ(rig.status(0).fault, AxisFault::emergency) << to_string(rig.status(0).fault);
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
  rig.run(20ms);
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

TEST(Fault, DriveWithoutCyclicTorqueIsRefusedByName) {
  Rig rig{{.supported_modes = 1}};  // profile position only
  EXPECT_FALSE(rig.start());
  EXPECT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
  EXPECT_EQ(rig.loop().drive(rig.id(0)).setup_status(), cia402::SetupStatus::no_torque_mode);
  EXPECT_EQ(rig.loop().drive(rig.id(0)).setup_object(), (canopen::ObjectAddress{0x6502, 0}));
}

struct Quirk {
  const char* label;
  void (*set)(drive_emulator::Quirks&);
  cia402::SetupStatus expected = cia402::SetupStatus::ready;
  std::uint16_t index = 0;  // of the object that is refused
};

class ADriveInTheField : public ::testing::TestWithParam<Quirk> {};

TEST_P(ADriveInTheField, SettlesOrIsRefusedByName) {
  RigConfig config;
  GetParam().set(config.quirks);
  Rig rig{config};
  const auto& drive = rig.loop().drive(rig.id(0));
  ASSERT_EQ(rig.start(), GetParam().expected == cia402::SetupStatus::ready) << to_string(drive.setup_status());
  EXPECT_EQ(drive.setup_status(), GetParam().expected) << to_string(drive.setup_status());
  EXPECT_EQ(drive.setup_object().index, GetParam().index);
  if (GetParam().expected != cia402::SetupStatus::ready) {
    EXPECT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
    return;
  }
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

INSTANTIATE_TEST_SUITE_P(
    Quirks, ADriveInTheField,
    ::testing::Values(
        Quirk{"ShowsItsModeLate", [](drive_emulator::Quirks& q) { q.mode_display_delay = 700ms; }},
        Quirk{"NeedsAMode", [](drive_emulator::Quirks& q) { q.needs_mode_to_enable = true; }},
        Quirk{"MissesFastControlwords", [](drive_emulator::Quirks& q) { q.min_controlword_interval = 3ms; }},
        Quirk{"AlarmsAtALateSync", [](drive_emulator::Quirks& q) { q.sync_alarm_periods = 2; }},
        Quirk{"TakesMillisecondsOnly", [](drive_emulator::Quirks& q) { q.interpolation_in_ms_only = true; }},
        Quirk{"StartsByItself", [](drive_emulator::Quirks& q) { q.self_starting = true; }},
        Quirk{"StartsByItselfAndMapsBeforeOnly",
              [](drive_emulator::Quirks& q) { q.self_starting = q.maps_in_pre_operational_only = true; }},
        Quirk{"SaysNoBootUp", [](drive_emulator::Quirks& q) { q.no_boot_up_message = true; }},
        Quirk{"SaysNoBootUpAndStartsByItself",
              [](drive_emulator::Quirks& q) {
                q.no_boot_up_message = q.self_starting = q.maps_in_pre_operational_only = true;
              }},
        Quirk{"ReversesItsPosition", [](drive_emulator::Quirks& q) { q.position_reversed = true; },
              cia402::SetupStatus::position_reversed, 0x607E},
        Quirk{"WrapsItsPosition", [](drive_emulator::Quirks& q) { q.position_range_counts = 131072; },
              cia402::SetupStatus::position_wraps, 0x607B},
        Quirk{"ScalesItsPosition", [](drive_emulator::Quirks& q) { q.feed_constant = 3600; },
              cia402::SetupStatus::position_scaled, 0x6092}),
    [](const auto& param_info) { return std::string{param_info.param.label}; });

// 6072h is lowered to the axis' limit, so that a drive gives that share of what it would be told in the rated torque.
TEST(Fault, ADriveThatCountsInItsLargestTorqueSettlesWhereTheFileSaysSo) {
  for (const Real max_force_N : {15.0F, 50.0F}) {
    RigConfig config;
    config.max_force_N = max_force_N;
    config.quirks.torque_relative_to_max = true;
    config.torque_base = cia402::TorqueBase::largest;
    Rig rig{config};
    ASSERT_TRUE(rig.start()) << to_string(rig.loop().drive(rig.id(0)).setup_status());
    rig.run(3s);
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
    EXPECT_LE(std::abs(rig.position_m(0)), 3e-6) << max_force_N;
  }
}

TEST(Fault, ADriveThatCountsInItsLargestTorqueIsNamedWhereTheFileSaysOtherwise) {
  RigConfig config{.start_m = -0.5};
  config.quirks.torque_relative_to_max = true;
  for (const auto& [max_force_N, expected] :
       {std::pair{15.0F, AxisFault::less_force_than_commanded}, std::pair{40.0F, AxisFault::force_not_commanded}}) {
    config.max_force_N = max_force_N;
    Rig rig{config};
    ASSERT_TRUE(rig.start());
    EXPECT_LE(rig.largest_force_N(0, 3s), max_force_N * 1.001);
    EXPECT_EQ(rig.status(0).fault, expected) << to_string(rig.status(0).fault) << " at " << max_force_N;
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
  }
}

TEST(Fault, ADriveThatCountsInItsRatedTorqueAndIsThoughtToCountInItsLargestIsNamed) {
  RigConfig config{.start_m = -0.5};
  config.max_force_N = 40;  // 1600 per mille
  config.torque_base = cia402::TorqueBase::largest;
  Rig rig{config};
  ASSERT_TRUE(rig.start());
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::less_force_than_commanded) << to_string(rig.status(0).fault);
}

TEST(Fault, AnAxisWhoseDriveScalesItsPositionSettlesToItsUnitWhereTheFileSaysSo) {
  RigConfig config;
  config.quirks.feed_constant = 2500;  // of 10000 counts: the encoder has four counts in a unit of position
  config.user_position_unit = true;
  Rig rig{config};
  ASSERT_TRUE(rig.start()) << to_string(rig.loop().drive(rig.id(0)).setup_status());
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

TEST(Fault, ANodeThatRefusesToStartIsNamedByTheErrorThatItTells) {
  RigConfig config;
  config.quirks.refuses_start_with = 0x6320;
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  rig.run(19s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  rig.run(2s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::emergency) << to_string(rig.status(0).fault);
  EXPECT_EQ(rig.loop().supervisor(rig.id(0)).fault_code(), 0x6320);
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
