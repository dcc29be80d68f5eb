// Drives as they are in the field: each settles, is refused as it is set up, or stops by name.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;

TEST(DriveKinds, DriveWithoutCyclicTorqueIsRefusedByName) {
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
        Quirk{"AnswersLate", [](drive_emulator::Quirks& q) { q.sdo_response_delay = 120ms; }},
        Quirk{"RefusesAtFirst", [](drive_emulator::Quirks& q) { q.sdo_busy = 2s; }},
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
        Quirk{"HasItsMappingFixedAsItIsNeeded",
              [](drive_emulator::Quirks& q) { q.fixed_mapping = drive_emulator::FixedMapping::fits; }},
        Quirk{"HasItsMappingFixedOtherwise",
              [](drive_emulator::Quirks& q) { q.fixed_mapping = drive_emulator::FixedMapping::differs; },
              cia402::SetupStatus::value_not_kept, 0x1600},
        Quirk{"RefusesWhatIsOptionalWithAnUnusualCode",
              [](drive_emulator::Quirks& q) {
                q.refused_objects = {0x1006, 0x1007, 0x1016, 0x6007, 0x605A, 0x605B, 0x605C, 0x605E,
                                     0x6075, 0x607B, 0x607E, 0x608F, 0x6091, 0x6092, 0x60B2, 0x60C2};
                q.refusal_code = 0x0606'0000;
              }},
        Quirk{"WantsBlocksForWhatIsOptional",
              [](drive_emulator::Quirks& q) {
                q.refused_objects = {0x1006, 0x1007, 0x6007, 0x60B2, 0x60C2};
                q.refusal_code = 0x0504'0001;
              }},
        Quirk{"WantsBlocksForWhatIsNeeded",
              [](drive_emulator::Quirks& q) {
                q.refused_objects = {0x6076};
                q.refusal_code = 0x0504'0001;
              },
              cia402::SetupStatus::object_refused, 0x6076},
        Quirk{"ReversesItsPosition", [](drive_emulator::Quirks& q) { q.position_reversed = true; },
              cia402::SetupStatus::position_reversed, 0x607E},
        Quirk{"WrapsItsPosition", [](drive_emulator::Quirks& q) { q.position_range_counts = 131072; },
              cia402::SetupStatus::position_wraps, 0x607B},
        Quirk{"WrapsItsPositionAtHalfItsCounts",
              [](drive_emulator::Quirks& q) { q.position_range_counts = 0x8000'0000; },
              cia402::SetupStatus::position_wraps, 0x607B},
        Quirk{"ScalesItsPosition", [](drive_emulator::Quirks& q) { q.feed_constant = 3600; },
              cia402::SetupStatus::position_scaled, 0x6092}),
    [](const auto& param_info) { return std::string{param_info.param.label}; });

// 6072h is lowered to the axis' limit, so that a drive gives that share of what it would be told in the rated torque.
TEST(DriveKinds, ADriveThatCountsInItsLargestTorqueSettlesWhereTheFileSaysSo) {
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

TEST(DriveKinds, ADriveThatCountsInItsLargestTorqueIsNamedWhereTheFileSaysOtherwise) {
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

TEST(DriveKinds, ADriveThatCountsInItsRatedTorqueAndIsThoughtToCountInItsLargestIsNamed) {
  RigConfig config{.start_m = -0.5};
  config.max_force_N = 40;  // 1600 per mille
  config.torque_base = cia402::TorqueBase::largest;
  Rig rig{config};
  ASSERT_TRUE(rig.start());
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::less_force_than_commanded) << to_string(rig.status(0).fault);
}

TEST(DriveKinds, AnAxisWhoseDriveScalesItsPositionSettlesToItsUnitWhereTheFileSaysSo) {
  RigConfig config;
  config.quirks.feed_constant = 2500;  // of 10000 counts: the encoder has four counts in a unit of position
  config.user_position_unit = true;
  Rig rig{config};
  ASSERT_TRUE(rig.start()) << to_string(rig.loop().drive(rig.id(0)).setup_status());
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

TEST(DriveKinds, ANodeThatRefusesToStartIsNamedByTheErrorThatItTells) {
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

// FFxxh, and one that its drive says in every fifth period while it works.
RigConfig talkative() {
  RigConfig config = far_from_target();
  config.quirks.informs_with = 0xFF01;
  config.quirks.informs_every = 5ms;
  config.emcy_information = {.first = {0x4210, 0xFF00}, .last = {0x4210, 0xFFFF}};
  return config;
}

// Starts it and has it speed up, for so long that its drive has said something.
void start_and_hear(Rig& rig) {
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  ASSERT_GT(rig.force_N(0), 10) << to_string(rig.status(0).fault);
  ASSERT_EQ(rig.loop().drive(rig.id(0)).last_emcy().code, 0xFF01);
  ASSERT_EQ(rig.status(0).fault, AxisFault::none);
}

void expect_stopped_by(Rig& rig, AxisFault fault, std::uint16_t code) {
  EXPECT_EQ(rig.status(0).fault, fault) << to_string(rig.status(0).fault);
  EXPECT_EQ(rig.loop().supervisor(rig.id(0)).fault_code(), code);
  rig.run(2ms);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << "two periods after the step that saw it";
  EXPECT_LT(rig.largest_force_N(0, 300ms), 0.1) << "latched";
}

TEST(DriveKinds, ADriveThatInformsByEmcySettlesWhereTheFileListsTheCode) {
  Rig rig{talkative()};
  start_and_hear(rig);
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
  EXPECT_EQ(rig.loop().drive(rig.id(0)).last_error_code(), 0);
}

TEST(DriveKinds, ADriveThatInformsByEmcyIsStoppedByThatCodeWhereTheFileDoesNotListIt) {
  RigConfig config = talkative();
  config.emcy_information = {.first = {0x4210, 0xFF02}, .last = {0x4210, 0xFF02}};
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  while (rig.status(0).fault == AxisFault::none && rig.now() < hal::Time{10s}) rig.step();
  expect_stopped_by(rig, AxisFault::emergency, 0xFF01);
}

// It comes with the first statusword that says Operation enabled.
TEST(DriveKinds, AnErrorThatADriveTellsAsItIsEnabledStopsTheAxis) {
  RigConfig config = talkative();
  config.emcy_information = {};
  config.quirks.informs_every = 3600s;
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  while (rig.status(0).fault == AxisFault::none && rig.now() < hal::Time{10s}) rig.step();
  expect_stopped_by(rig, AxisFault::emergency, 0xFF01);
}

TEST(DriveKinds, AnErrorAmongInformationStopsTheAxisInThePeriodInWhichItIsHeard) {
  for (int onset = 0; onset < 6; ++onset) {  // before, with and after what the drive says by itself
    Rig rig{talkative()};
    start_and_hear(rig);
    auto& other = rig.network().add_port();
    rig.run(onset * 1ms);
    for (const std::uint16_t code : std::array<std::uint16_t, 3>{0x4210, 0x3110, 0xFF02})
      ASSERT_EQ(other.send(canopen::emcy_frame({.code = code}, 1), rig.now() + 1s), hal::SendResult::queued);
    rig.step();
    expect_stopped_by(rig, AxisFault::emergency, 0x3110);
    EXPECT_NE(rig.loop().drive(rig.id(0)).last_emcy().code, 0x3110) << "something newer was told";
  }
}

// The code is that of 603Fh, because its EMCY was told to be information.
TEST(DriveKinds, ADriveInFaultStopsTheAxisWhateverTheFileListsAsInformation) {
  Rig rig{talkative()};
  start_and_hear(rig);
  rig.drive(0).trip_fault(0x4210, rig.now());
  const hal::Time begin = rig.now();
  steps_until_fault(rig, 10);
  EXPECT_LE(rig.now() - begin, 2ms) << "a period after the SYNC at which the drive shows it";
  rig.run(20ms);
  expect_stopped_by(rig, AxisFault::drive_fault, 0x4210);
  EXPECT_EQ(rig.loop().drive(rig.id(0)).last_error_code(), 0);
  rig.loop().reset_fault(rig.id(0));
  rig.run(5s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

TEST(DriveKinds, ADriveThatTakesASecondForAnAnswerIsSetUpWhileTheOthersRun) {
  RigConfig config;
  config.axes = 2;
  Rig rig{config};
  rig.drive(0).delay_sdo_responses(1s);
  rig.loop().request_enable(rig.id(0));
  rig.loop().request_enable(rig.id(1));
  rig.run(3s);
  EXPECT_TRUE(rig.status(1).running) << to_string(rig.status(1).fault);
  while (!rig.status(0).running && rig.now() < hal::Time{140s}) rig.step();
  EXPECT_TRUE(rig.status(0).running) << to_string(rig.status(0).fault) << " after "
                                     << to_string(rig.loop().drive(rig.id(0)).setup_status());
  EXPECT_LE(std::abs(rig.position_m(1)), 3e-6);
}

TEST(DriveKinds, ADriveThatAnswersTooLateIsNamedInTime) {
  RigConfig config;
  config.quirks.sdo_response_delay = 30s;
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  rig.run(21s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::enable_timed_out) << to_string(rig.status(0).fault);
}

TEST(DriveKinds, ADriveThatGoesOnRefusingIsNamedWithTheObject) {
  RigConfig config;
  config.quirks.sdo_busy = 60s;
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  rig.run(5s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
  EXPECT_EQ(rig.loop().supervisor(rig.id(0)).fault_code(), 0) << "the drive told of no error";
  EXPECT_EQ(rig.loop().drive(rig.id(0)).setup_status(), cia402::SetupStatus::object_refused);
  EXPECT_EQ(rig.loop().drive(rig.id(0)).setup_abort_code(), canopen::SdoAbort::device_state);
}

}  // namespace
}  // namespace breakaway::closed_loop
