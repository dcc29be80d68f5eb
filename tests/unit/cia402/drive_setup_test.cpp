// How a node is set up, and which drives are refused.
#include <algorithm>
#include <array>
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

}  // namespace
}  // namespace breakaway::test
