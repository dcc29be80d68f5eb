// How a node is set up, and which drives are refused.
#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "drive_fixture.hpp"

namespace breakaway::test {
namespace {

TEST_F(DriveTest, SetsUpABootedNodeInTheProfilesOrder) {
  set_up();
  const auto key = ScriptedDrive::key;
  const std::vector<std::uint32_t> expected{
      key(0x6040, 0), key(0x6071, 0), key(0x60B2, 0), key(0x6072, 0), key(0x605A, 0), key(0x605B, 0), key(0x605C, 0),
      key(0x605E, 0), key(0x1016, 1), key(0x1017, 0), key(0x1005, 0), key(0x1006, 0), key(0x1007, 0), key(0x60C2, 1),
      key(0x60C2, 2), key(0x1400, 1), key(0x1600, 0), key(0x1600, 1), key(0x1600, 2), key(0x1600, 0), key(0x1400, 2),
      key(0x1400, 1), key(0x1800, 1), key(0x1A00, 0), key(0x1A00, 1), key(0x1A00, 2), key(0x1A00, 3), key(0x1A00, 0),
      key(0x1800, 2), key(0x1800, 1), key(0x1400, 5), key(0x6007, 0), key(0x6060, 0)};
  EXPECT_EQ(node.written, expected);
  EXPECT_EQ(node.commands, (std::vector<NmtCommand>{NmtCommand::enter_pre_operational, NmtCommand::start}));
  EXPECT_EQ(node.objects[key(0x1600, 1)], 0x60400010U);
  EXPECT_EQ(node.objects[key(0x1600, 2)], 0x60710010U);
  EXPECT_EQ(node.objects[key(0x1A00, 2)], 0x60640020U);
  EXPECT_EQ(node.objects[key(0x1400, 1)], 0x204U);
  EXPECT_EQ(drive.nmt_state(), NmtState::operational);
  EXPECT_FLOAT_EQ(drive.torque_quantum_N(), 0.05F);
}

TEST_F(DriveTest, OneAcyclicFrameAPeriodAtMost) {
  node.boot();
  deliver();
  for (int i = 0; i < 500; ++i) {
    step();
    int acyclic = 0;
    for (const CanFrame& frame : sent) acyclic += !is_sync(frame) && frame.id != rpdo_cob_id(1, node_id) ? 1 : 0;
    ASSERT_LE(acyclic, 1);
  }
}

TEST_F(DriveTest, SilentNodeIsToldToResetItsCommunication) {
  run_until([&] { return !node.commands.empty(); });
  EXPECT_EQ(node.commands[0], NmtCommand::reset_communication);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.reboots(), 0U) << "this boot-up was asked for";
}

TEST_F(DriveTest, NodeThatRunsAlreadyIsTakenBackFirst) {
  node.nmt = NmtState::operational;
  node.objects[ScriptedDrive::key(0x1017, 0)] = 50;
  run_until_state(DriveState::disabled);
  ASSERT_EQ(node.commands.size(), 2U);
  EXPECT_EQ(node.commands[0], NmtCommand::enter_pre_operational);
  EXPECT_EQ(node.commands[1], NmtCommand::start);
}

TEST_F(DriveTest, NodeThatComesLateIsSetUpWhenItComes) {
  node.silent = true;
  run_for(10s);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(drive.setup_status(), SetupStatus::in_progress);
  node.silent = false;
  set_up();
}

TEST_F(DriveTest, NodeThatVanishesDuringSetUpIsReportedAndAwaited) {
  node.boot();
  deliver();
  run_for(10ms);
  node.silent = true;
  run_for(2500ms);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_answer);
  EXPECT_NE(drive.setup_object().index, 0) << "the object that was not answered";
  run_for(3s);
  EXPECT_NE(drive.setup_object().index, 0) << "whatever it is told meanwhile";
  EXPECT_EQ(feedback.state, DriveState::configuring);
  node.silent = false;
  set_up();
}

struct Refusal {
  const char* label;
  std::uint16_t index;
  std::uint32_t value;
  SetupStatus status;
};
class DriveRefusal : public DriveTest, public testing::WithParamInterface<Refusal> {};

TEST_P(DriveRefusal, UnfitDriveStaysUnusableAndNamesTheObject) {
  node.objects[ScriptedDrive::key(GetParam().index, 0)] = GetParam().value;
  node.boot();
  deliver();
  run_until([&] { return feedback.state == DriveState::unusable; }, 15s);
  EXPECT_EQ(drive.setup_status(), GetParam().status);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{GetParam().index, 0}));
  EXPECT_EQ(drive.setup_abort_code(), SdoAbort::none);
  drive.request_enable();
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::unusable);
  EXPECT_FALSE(node.state == State::operation_enabled);
}
INSTANTIATE_TEST_SUITE_P(Objects, DriveRefusal,
                         testing::Values(Refusal{"OtherProfile", 0x1000, 401, SetupStatus::not_a_cia402_drive},
                                         Refusal{"NoCyclicTorque", 0x6502, 0x1FF, SetupStatus::no_torque_mode},
                                         Refusal{"NoRatedTorque", 0x6076, 0, SetupStatus::no_rated_torque},
                                         Refusal{"NoTorqueAllowed", 0x6072, 0, SetupStatus::no_max_torque},
                                         Refusal{"OtherModeShown", 0x6061, 4, SetupStatus::mode_refused}),
                         [](const auto& row) { return row.param.label; });

TEST_F(DriveTest, AbortedWriteIsReportedWithItsObject) {
  node.refused[ScriptedDrive::key(0x1A00, 2)] = SdoAbort::not_mappable;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::object_refused);
  EXPECT_EQ(drive.setup_abort_code(), SdoAbort::not_mappable);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x1A00, 2}));
}

TEST_F(DriveTest, LackOfWhatIsRequiredIsReported) {
  for (const std::uint16_t index : {std::uint16_t{0x6076}, std::uint16_t{0x1000}, std::uint16_t{0x6502}}) {
    ScriptedDrive lacking{node_id};
    lacking.objects.erase(ScriptedDrive::key(index, 0));
    std::swap(node, lacking);
    node.boot();
    deliver();
    step();
    run_until_state(DriveState::unusable);
    EXPECT_EQ(drive.setup_status(), SetupStatus::object_refused);
    EXPECT_EQ(drive.setup_abort_code(), SdoAbort::no_such_object);
    EXPECT_EQ(drive.setup_object(), (ObjectAddress{index, 0}));
  }
}

TEST_F(DriveTest, AnswerThatTheStandardForbidsIsReportedWithItsObject) {
  node.boot();
  deliver();
  node.silent = true;
  step();  // takes it to Pre-operational
  step();  // writes 6040h
  drive.on_frame(
      {.frame = {.id = sdo_response_cob_id(node_id), .size = 8, .data = {0xC0, 0x40, 0x60, 0x00}}, .time = now});
  step();
  EXPECT_EQ(feedback.state, DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::protocol_error);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x6040, 0}));
}

TEST_F(DriveTest, OneThatRebootsAfterARefusalIsSetUpAnew) {
  node.refused[ScriptedDrive::key(0x1A00, 2)] = SdoAbort::not_mappable;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.refused.clear();
  set_up();
  EXPECT_EQ(drive.setup_abort_code(), SdoAbort::none);
}

TEST_F(DriveTest, LacksWhatIsOptional) {
  node.objects.erase(ScriptedDrive::key(0x6075, 0));
  node.objects.erase(ScriptedDrive::key(0x6072, 0));
  node.refused[ScriptedDrive::key(0x1006, 0)] = SdoAbort::no_such_object;
  node.refused[ScriptedDrive::key(0x60C2, 2)] = SdoAbort::read_only;
  set_up();
  EXPECT_FLOAT_EQ(drive.max_force_N(), 50.0F) << "not beyond the rated torque";
}

// Vendors abort with whatever code they like.
TEST_F(DriveTest, WhatIsOptionalMayBeRefusedWithAnyAbortCode) {
  int code = 0;
  constexpr std::array codes{SdoAbort::device_state, SdoAbort::general_error, SdoAbort::local_control,
                             SdoAbort::unsupported_access, SdoAbort::value_too_low};
  for (const auto& [index, subindex] : {std::pair{0x1005, 0},
                                        {0x1006, 0},
                                        {0x1016, 1},
                                        {0x60B2, 0},
                                        {0x605A, 0},
                                        {0x605B, 0},
                                        {0x605C, 0},
                                        {0x605E, 0},
                                        {0x6007, 0},
                                        {0x1400, 5},
                                        {0x60C2, 1},
                                        {0x60C2, 2},
                                        {0x6071, 0},
                                        {0x6075, 0}})
    node.refused[ScriptedDrive::key(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(subindex))] =
        codes[static_cast<std::size_t>(code++) % codes.size()];
  node.boot();
  deliver();
  step();
  run_until([&] { return feedback.state == DriveState::disabled; }, 6s);  // what may pass is asked again for 3 s
  drive.request_enable();
  run_until_state(DriveState::enabled);
  EXPECT_EQ(node.state, State::operation_enabled);
}

TEST_F(DriveTest, LowersTheDrivesTorqueLimitToTheAxisOwnAndNeverRaisesIt) {
  set_up();
  EXPECT_EQ(node.value_of(0x6072, 0), 1200U) << "60 N of 0.05 N a per mille";
  EXPECT_FLOAT_EQ(drive.max_force_N(), 60.0F);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 2000) << "for whoever is to use the drive next";
  node.objects[ScriptedDrive::key(0x6072, 0)] = 400;
  set_up();
  EXPECT_EQ(node.value_of(0x6072, 0), 400U);
  EXPECT_FLOAT_EQ(drive.max_force_N(), 20.0F);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 400) << "it booted meanwhile";
  EXPECT_EQ(std::count(node.written.begin(), node.written.end(), ScriptedDrive::key(0x6072, 0)), 1);
}

TEST_F(DriveTest, AnOptionCodeThatIsFixedIsNoReasonToRefuseADriveButATorqueOffsetIs) {
  const auto key = ScriptedDrive::key;
  for (const std::uint32_t object : {key(0x605A, 0), key(0x605E, 0)}) {
    node.read_only.insert(object);
    node.objects[object] = 2;
  }
  node.read_only.insert(key(0x60B2, 0));
  node.objects[key(0x60B2, 0)] = 0;
  set_up();
  node.objects[key(0x60B2, 0)] = 5;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::value_not_kept);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x60B2, 0}));
}

TEST_F(DriveTest, TakesTheTorqueLimitThatTheDriveKeeps) {
  node.refused[ScriptedDrive::key(0x6072, 0)] = SdoAbort::read_only;
  set_up();
  EXPECT_FLOAT_EQ(drive.max_force_N(), 50.0F) << "of a drive that does not say, its rated torque";
}

TEST_F(DriveTest, ReadsATorqueLimitThatItCannotLower) {
  node.read_only.insert(ScriptedDrive::key(0x6072, 0));
  set_up();
  EXPECT_EQ(node.value_of(0x6072, 0), 2000U);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 2000);
}

TEST_F(DriveTest, TakesAwayWhatAnotherToolLeftInTheDrive) {
  const auto key = ScriptedDrive::key;
  constexpr std::array<std::uint16_t, 6> cleared{0x60B2, 0x605A, 0x605B, 0x605C, 0x605E, 0x6071};
  for (const std::uint16_t index : cleared) node.objects[key(index, 0)] = 3;
  node.objects[key(0x1005, 0)] = 0x81;
  set_up();
  for (const std::uint16_t index : cleared) EXPECT_EQ(node.value_of(index, 0), 0U) << std::hex << index;
  EXPECT_EQ(node.value_of(0x1005, 0), 0x80U);
}

class DriveThatKeeps : public DriveTest, public testing::WithParamInterface<std::pair<std::uint16_t, std::uint32_t>> {};

// What is written is refused, and what is read is wrong.
TEST_P(DriveThatKeeps, AValueThatAddsForceOrHearsAnotherSyncIsUnusableByName) {
  const auto [index, value] = GetParam();
  node.kept[ScriptedDrive::key(index, 0)] = value;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::value_not_kept);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{index, 0}));
}
INSTANTIATE_TEST_SUITE_P(Objects, DriveThatKeeps,
                         testing::Values(std::pair{0x60B2, 600}, std::pair{0x60B2, 1}, std::pair{0x1005, 0x81},
                                         std::pair{0x1005, 0x40000080}, std::pair{0x605A, 6}, std::pair{0x605E, 2}));

TEST_F(DriveTest, BitsOf1005hThatSayNothingAreNoReasonToRefuseADrive) {
  node.kept[ScriptedDrive::key(0x1005, 0)] = 0x80000080;
  set_up();
}

struct RatedTorque {
  const char* label;
  std::uint32_t told_mNm, shown_mNm;
  std::optional<SetupStatus> refused;
};
class DriveWithARatedTorque : public DriveTest, public testing::WithParamInterface<RatedTorque> {
 protected:
  static DriveConfig<float> told() {
    DriveConfig<float> changed = config;
    changed.rated_torque_mNm = GetParam().told_mNm;
    return changed;
  }
  DriveWithARatedTorque() : DriveTest{told()} {}
};

TEST_P(DriveWithARatedTorque, IsTakenWhereTheFileAgreesAndRefusedByNameElsewhere) {
  node.objects[ScriptedDrive::key(0x6076, 0)] = GetParam().shown_mNm;
  node.boot();
  deliver();
  run_until_state(GetParam().refused ? DriveState::unusable : DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), GetParam().refused.value_or(SetupStatus::ready));
}
INSTANTIATE_TEST_SUITE_P(
    Of, DriveWithARatedTorque,
    testing::Values(RatedTorque{"NothingTold", 0, 7, {}}, RatedTorque{"TheSame", 500, 500, {}},
                    RatedTorque{"ARoundedFigure", 500, 496, {}}, RatedTorque{"OneOff", 7, 8, {}},
                    RatedTorque{"AHundredthOfTheLarger", 10'000, 9'900, {}},
                    RatedTorque{"MoreThanAHundredth", 10'000, 9'899, SetupStatus::rated_torque_differs},
                    RatedTorque{"AThousandTimesToAHundredth", 500, 495'000, SetupStatus::rated_torque_unit},
                    RatedTorque{"AThousandthToAHundredth", 4'950, 5, SetupStatus::rated_torque_unit},
                    RatedTorque{"More", 500, 520, SetupStatus::rated_torque_differs},
                    RatedTorque{"Less", 500, 480, SetupStatus::rated_torque_differs},
                    RatedTorque{"TenTimes", 500, 5000, SetupStatus::rated_torque_differs},
                    RatedTorque{"AThousandTimes", 500, 500'000, SetupStatus::rated_torque_unit},
                    RatedTorque{"AThousandth", 5000, 5, SetupStatus::rated_torque_unit},
                    RatedTorque{"TheMostThereIs", 4'294'968, 0xFFFFFFFF, SetupStatus::rated_torque_unit}),
    [](const auto& row) { return row.param.label; });

class DriveOfTheLargestTorque : public DriveTest {
 protected:
  DriveOfTheLargestTorque() : DriveTest{counting_in_the_largest()} {}
  static DriveConfig<float> counting_in_the_largest() {
    DriveConfig<float> told = config;
    told.torque_base = breakaway::cia402::TorqueBase::largest;
    return told;
  }
};

// 0.05 N a per mille: 60 N are 1200.
TEST_F(DriveOfTheLargestTorque, HasItLoweredToTheAxisLimitAndIsSentPerMilleOfThat) {
  enable();
  EXPECT_EQ(node.value_of(0x6072, 0), 1200U);
  step(30.0F);
  EXPECT_EQ(node.target, 500);
  step(-1000.0F);
  EXPECT_EQ(node.target, -1000);
}

TEST_F(DriveOfTheLargestTorque, IsRefusedByNameWhereItCannotBeTheAxisLimit) {
  node.objects[ScriptedDrive::key(0x6072, 0)] = 1100;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::torque_base_differs);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x6072, 0}));
}

TEST_F(DriveOfTheLargestTorque, IsRefusedByNameWhereItKeepsAnother) {
  node.kept[ScriptedDrive::key(0x6072, 0)] = 2000;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::torque_base_differs);
}

// 608Fh is 10000 counts a turn; 6092h:01 is `feed`.
struct Units {
  std::uint32_t feed;
  bool told;  // position_unit = "user"
  SetupStatus status;
};
class DriveWithUnits : public DriveTest, public testing::WithParamInterface<Units> {
 protected:
  DriveWithUnits() : DriveTest{told_units()} {}
  static DriveConfig<float> told_units() {
    DriveConfig<float> told = config;
    told.user_position_unit = GetParam().told;
    return told;
  }
};
TEST_P(DriveWithUnits, AreTakenWhereTheFileExpectsThemAndRefusedByNameElsewhere) {
  node.objects[ScriptedDrive::key(0x608F, 1)] = 10'000;
  node.objects[ScriptedDrive::key(0x6092, 1)] = GetParam().feed;
  node.boot();
  deliver();
  const bool good = GetParam().status == SetupStatus::ready;
  run_until_state(good ? DriveState::disabled : DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), GetParam().status);
  EXPECT_EQ(drive.setup_object(), good ? ObjectAddress{} : (ObjectAddress{0x6092, 2}));
}
INSTANTIATE_TEST_SUITE_P(
    Of, DriveWithUnits,
    testing::Values(Units{10'000, false, SetupStatus::ready}, Units{10'000, true, SetupStatus::ready},
                    Units{3'600, false, SetupStatus::position_scaled}, Units{3'600, true, SetupStatus::ready},
                    Units{36'000, false, SetupStatus::position_scaled},
                    Units{36'000, true, SetupStatus::position_too_fine}),
    [](const auto& row) { return std::to_string(row.param.feed) + (row.param.told ? "Told" : "Untold"); });

TEST_F(DriveTest, UnitsThatAreMendedAreTakenAtTheNextReset) {
  node.objects[ScriptedDrive::key(0x6091, 1)] = 3;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.objects[ScriptedDrive::key(0x6091, 1)] = 1;
  drive.reset_fault();
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), SetupStatus::ready);
}

TEST_F(DriveTest, UnitsOfADriveThatBootsAreItsOwn) {
  const auto key = ScriptedDrive::key;
  node.objects[key(0x6091, 1)] = 3;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.objects.erase(key(0x6091, 1));
  set_up();
}

TEST_F(DriveTest, ModeDisplayMayLagForSeconds) {
  node.objects[ScriptedDrive::key(0x6061, 0)] = 0xFF;
  node.boot();
  deliver();
  drive.request_enable();
  run_for(4s);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(node.controlword, 0x00) << "not enabled before the mode is sure";
  const auto requests = std::count(node.written.begin(), node.written.end(), ScriptedDrive::key(0x6060, 0));
  EXPECT_GE(requests, 5);
  node.objects[ScriptedDrive::key(0x6061, 0)] = 10;
  run_until_state(DriveState::enabled);
}

TEST(BadDriveConfig, IsUnusableFromTheStart) {
  struct Given {
    DriveConfig<float> config;
    NetworkConfig network;
    AxisScale<float> scale;
  };
  const auto expect = [](DriveConfigError error, auto change) {
    Given given{config, network, scale};
    change(given);
    Drive<float> drive{given.config, given.network, given.scale};
    // A boot-up message, which has a refused node set up anew, changes nothing here.
    drive.on_frame(
        {.frame = breakaway::canopen::heartbeat_frame(NmtState::boot_up, given.config.node_id), .time = Time{1s}});
    drive.update(Time{1s});
    EXPECT_EQ(drive.setup_status(), SetupStatus::config_invalid);
    EXPECT_EQ(drive.config_error(), error);
    EXPECT_EQ(drive.feedback().state, DriveState::unusable);
    CanFrame frame;
    EXPECT_FALSE(drive.next_acyclic_frame(frame, Time{1s}));
    EXPECT_FALSE(drive.next_command_frame(frame));
  };
  expect(DriveConfigError::node_id, [](Given& g) { g.config.node_id = 0; });
  expect(DriveConfigError::master_node_id, [](Given& g) { g.network.node_id = g.config.node_id; });
  expect(DriveConfigError::period, [](Given& g) { g.network.period = 0ms; });
  expect(DriveConfigError::encoder_resolution, [](Given& g) { g.scale.encoder_resolution_m = 0; });
  expect(DriveConfigError::force_per_torque,
         [](Given& g) { g.config.force_per_torque_N_per_Nm = std::numeric_limits<float>::quiet_NaN(); });
  expect(DriveConfigError::max_force, [](Given& g) { g.scale.max_force_N = -1; });
}

class WeakAxisTest : public DriveTest {
 protected:
  // The limit is less than one per mille of the rated torque.
  WeakAxisTest() : DriveTest{config, {.encoder_resolution_m = 1e-6F, .max_force_N = 0.04F}} {}
};

TEST_F(WeakAxisTest, LimitBelowOneQuantumIsUnusable) {
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
  EXPECT_EQ(drive.config_error(), DriveConfigError::none);
  node.boot();
  deliver();
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::unusable) << "it is the same drive";
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
}

TEST_F(WeakAxisTest, AReadingOfTheRatingThatWasWrongIsMendedByAReset) {
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.objects[ScriptedDrive::key(0x6076, 0)] = 500;
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::unusable);
  drive.reset_fault();
  run_for(1ms);
  EXPECT_NE(feedback.state, DriveState::unusable) << "or the fault would be latched again";
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.setup_status(), SetupStatus::ready);
}

}  // namespace
}  // namespace breakaway::test
