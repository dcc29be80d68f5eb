#include "breakaway/cia402/drive.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "scripted_drive.hpp"

namespace {

using namespace std::chrono_literals;
using breakaway::canopen::emcy_cob_id;
using breakaway::canopen::heartbeat_cob_id;
using breakaway::canopen::is_sync;
using breakaway::canopen::NetworkConfig;
using breakaway::canopen::NmtCommand;
using breakaway::canopen::NmtState;
using breakaway::canopen::ObjectAddress;
using breakaway::canopen::rpdo_cob_id;
using breakaway::canopen::sdo_request_cob_id;
using breakaway::canopen::sdo_response_cob_id;
using breakaway::canopen::SdoAbort;
using breakaway::canopen::tpdo_cob_id;
using breakaway::cia402::Drive;
using breakaway::cia402::DriveConfig;
using breakaway::cia402::DriveConfigError;
using breakaway::cia402::SetupStatus;
using breakaway::cia402::State;
using breakaway::hal::AxisScale;
using breakaway::hal::CanFrame;
using breakaway::hal::DriveFeedback;
using breakaway::hal::DriveState;
using breakaway::hal::Duration;
using breakaway::hal::Time;
using breakaway::test::ScriptedDrive;

constexpr std::uint8_t node_id = 4;

// 1 um a count, 50 N at the rated torque: 0.05 N a per mille.
constexpr DriveConfig<float> config{.node_id = node_id, .force_per_torque_N_per_Nm = 50.0F};
constexpr NetworkConfig network{.period = 1ms};
constexpr AxisScale<float> scale{.encoder_resolution_m = 1e-6F, .max_force_N = 60.0F};
static_assert(check(config, network, scale) == DriveConfigError::none);

class DriveTest : public testing::Test {
 protected:
  explicit DriveTest(const DriveConfig<float>& drive_config = config, const AxisScale<float>& axis_scale = scale)
      : drive{drive_config, network, axis_scale} {}

  Drive<float> drive;
  ScriptedDrive node{node_id};
  Time now{};
  DriveFeedback<float> feedback{};
  std::vector<CanFrame> sent;

  void deliver() {
    std::vector<CanFrame> frames;
    frames.swap(node.out);
    for (const CanFrame& frame : frames) drive.on_frame({.frame = frame, .time = now + 300us});
  }
  void send(const CanFrame& frame) {
    sent.push_back(frame);
    node.on_frame(frame);
  }
  // One period of the control loop.
  void step(std::optional<float> force_N = std::nullopt) {
    now += 1ms;
    node.advance_to(now);
    drive.update(now);
    feedback = drive.feedback();
    if (force_N) drive.command(*force_N);
    sent.clear();
    send(breakaway::canopen::sync_frame());
    drive.on_sync(now);
    CanFrame frame;
    if (drive.next_command_frame(frame)) send(frame);
    if (drive.next_acyclic_frame(frame, now)) send(frame);
    deliver();
  }
  template <class Condition>
  void run_until(Condition condition, Duration limit = 3s) {
    const Time end = now + limit;
    while (!condition()) {
      ASSERT_LT(now, end) << "state " << static_cast<int>(feedback.state);
      step();
    }
  }
  void run_for(Duration duration) {
    for (const Time end = now + duration; now < end;) step();
  }
  void run_until_state(DriveState state) {
    run_until([&] { return feedback.state == state; });
  }
  void set_up() {
    node.boot();
    deliver();
    run_until_state(DriveState::disabled);
    ASSERT_EQ(drive.setup_status(), SetupStatus::ready);
    EXPECT_EQ(drive.setup_object(), ObjectAddress{});
  }
  void enable() {
    set_up();
    drive.request_enable();
    run_until_state(DriveState::enabled);
  }
};

TEST_F(DriveTest, SetsUpABootedNodeInTheProfilesOrder) {
  set_up();
  const auto key = ScriptedDrive::key;
  const std::vector<std::uint32_t> expected{
      key(0x1016, 1), key(0x1017, 0), key(0x1006, 0), key(0x60C2, 1), key(0x60C2, 2), key(0x1400, 1),
      key(0x1600, 0), key(0x1600, 1), key(0x1600, 2), key(0x1600, 0), key(0x1400, 2), key(0x1400, 1),
      key(0x1800, 1), key(0x1A00, 0), key(0x1A00, 1), key(0x1A00, 2), key(0x1A00, 3), key(0x1A00, 0),
      key(0x1800, 2), key(0x1800, 1), key(0x1400, 5), key(0x6007, 0), key(0x6060, 0)};
  EXPECT_EQ(node.written, expected);
  EXPECT_EQ(node.commands, (std::vector<NmtCommand>{NmtCommand::start}));
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
  run_for(300ms);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_answer);
  EXPECT_NE(drive.setup_object().index, 0) << "the object that was not answered";
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
  step();  // asks for 1000h
  drive.on_frame(
      {.frame = {.id = sdo_response_cob_id(node_id), .size = 8, .data = {0xC0, 0x00, 0x10, 0x00}}, .time = now});
  step();
  EXPECT_EQ(feedback.state, DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::protocol_error);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x1000, 0}));
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

TEST_F(DriveTest, WalksToEnabledAndSendsTheForceInPerMille) {
  enable();
  step(10.0F);
  EXPECT_EQ(node.controlword, 0x0F);
  EXPECT_EQ(node.target, 200);
  step(-1e9F);
  EXPECT_EQ(node.target, -1200);
}

TEST_F(DriveTest, ForceIsZeroWithoutANewCommand) {
  enable();
  step(10.0F);
  step();
  EXPECT_EQ(node.target, 0);
}

TEST_F(DriveTest, ForceIsZeroUnlessEnabled) {
  set_up();
  step(10.0F);
  EXPECT_EQ(node.target, 0);
  drive.request_enable();
  while (feedback.state != DriveState::enabled) {
    ASSERT_EQ(node.target, 0);
    step(10.0F);
    ASSERT_LT(now, Time{3s});
  }
  EXPECT_EQ(node.target, 200);
  drive.request_stop();
  step(10.0F);
  EXPECT_EQ(node.target, 0);
  EXPECT_EQ(node.controlword, 0x02);
}

TEST_F(DriveTest, NotANumberIsNoForce) {
  enable();
  step(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(node.target, 0);
}

TEST_F(DriveTest, StopsAndEnablesAgain) {
  enable();
  drive.request_stop();
  run_until_state(DriveState::stopping);
  node.state = State::switch_on_disabled;  // the quick stop is over
  run_until_state(DriveState::disabled);
  run_for(20ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, SilentDropStaysOffUntilEnabledAgain) {
  enable();
  node.state = State::switched_on;
  step(10.0F);
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(node.target, 0);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, FaultIsLatchedNamedAndReset) {
  enable();
  node.state = State::fault;
  node.emergency(0x8611);
  run_until_state(DriveState::fault);
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, 0x8611);
  drive.request_enable();
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
  drive.reset_fault();
  run_until_state(DriveState::disabled);
  EXPECT_EQ(feedback.fault_code, 0);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, FaultWithoutEmergencyIsAskedForItsCode) {
  enable();
  node.state = State::fault;
  run_until([&] { return feedback.fault_code != 0; });
  EXPECT_EQ(feedback.fault_code, 0x2310);
}

TEST_F(DriveTest, RebootIsReportedAndSetUpAnewButNotEnabled) {
  enable();
  node.boot();
  deliver();
  step(10.0F);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_FALSE(feedback.ever_valid);
  EXPECT_EQ(drive.reboots(), 1U);
  run_until_state(DriveState::disabled);
  run_for(200ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(DriveTest, HeartbeatLossIsSeenAndPasses) {
  enable();
  node.silent = true;
  const Time begin = now;
  run_until([&] { return drive.heartbeat_lost(); });
  EXPECT_GE(now - begin, 150ms);
  EXPECT_LE(now - begin, 252ms);
  node.silent = false;
  run_until([&] { return !drive.heartbeat_lost(); });
  EXPECT_EQ(feedback.state, DriveState::enabled) << "what to do about it is the supervisor's";
}

TEST_F(DriveTest, NodeThatLeavesOperationalIsStartedAgainButNotEnabled) {
  enable();
  node.nmt = NmtState::pre_operational;
  node.state = State::switch_on_disabled;
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(node.nmt, NmtState::operational);
  EXPECT_EQ(drive.reboots(), 0U);
}

TEST_F(DriveTest, FeedbackIsFreshOncePerSampleAndCarriesTheTimeOfItsSync) {
  set_up();
  node.counts = 1234;
  node.torque = -40;
  step();
  const Time sync = now;
  step();
  EXPECT_TRUE(feedback.fresh);
  EXPECT_TRUE(feedback.ever_valid);
  EXPECT_EQ(feedback.sample_time, sync);
  EXPECT_FLOAT_EQ(feedback.position_m, 1234e-6F);
  EXPECT_FLOAT_EQ(feedback.force_N, -2.0F);
  EXPECT_TRUE(drive.feedback().fresh) << "the sample of the second period";
  EXPECT_FALSE(drive.feedback().fresh);
}

TEST_F(DriveTest, SampleWithoutKnownSyncHasTheTimeOfItsFrame) {
  set_up();
  now += 1s;  // the last SYNC is long ago
  CanFrame frame{.id = tpdo_cob_id(1, node_id), .size = 8, .data = {}};
  drive.on_frame({.frame = frame, .time = now});
  EXPECT_EQ(drive.feedback().sample_time, now);
}

TEST_F(DriveTest, OffsetFromTheDatumIsExactAcrossTheEndOfTheRange) {
  set_up();
  constexpr auto highest = std::numeric_limits<std::int32_t>::max();
  constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
  struct Row {
    std::int32_t datum, counts;
    float offset_m;
  };
  for (const Row& row : {Row{highest, lowest, 1e-6F}, Row{lowest, highest, -1e-6F}, Row{highest - 1, highest, 1e-6F},
                         Row{100, 97, -3e-6F}, Row{2'000'000'001, 2'000'000'003, 2e-6F}}) {
    drive.set_datum_counts(row.datum);
    node.counts = row.counts;
    step();
    EXPECT_FLOAT_EQ(drive.feedback().position_offset_m, row.offset_m) << row.datum;
  }
}

TEST_F(DriveTest, TellsWhatItSharesWithTheController) {
  EXPECT_EQ(drive.encoder_resolution_m(), scale.encoder_resolution_m);
  EXPECT_EQ(drive.max_force_N(), scale.max_force_N) << "until the drive's own limit is known";
  EXPECT_EQ(drive.node_id(), node_id);
}

TEST_F(DriveTest, CountsOfAPositionSaturate) {
  EXPECT_EQ(drive.counts_at(0.001F), 1000);
  EXPECT_EQ(drive.counts_at(-0.0000014F), -1);
  EXPECT_EQ(drive.counts_at(1e9F), std::numeric_limits<std::int32_t>::max());
  EXPECT_EQ(drive.counts_at(-1e9F), std::numeric_limits<std::int32_t>::min());
}

TEST_F(DriveTest, OtherNodesFramesChangeNothing) {
  enable();
  const auto before = drive.statusword();
  constexpr std::uint8_t other = node_id + 1;
  for (const std::uint16_t id :
       {tpdo_cob_id(1, other), emcy_cob_id(other), sdo_response_cob_id(other), heartbeat_cob_id(other),
        tpdo_cob_id(2, node_id), rpdo_cob_id(1, node_id), sdo_request_cob_id(node_id)})
    drive.on_frame({.frame = {.id = id, .size = 8, .data = {0x08, 0, 0, 0, 0, 0, 0, 0}}, .time = now});
  step();
  EXPECT_EQ(drive.statusword(), before);
  EXPECT_EQ(feedback.state, DriveState::enabled);
  EXPECT_EQ(drive.last_emcy().code, 0);
}

TEST_F(DriveTest, DriveThatStayedEnergisedOutsideOfOperationalIsSwitchedOff) {
  enable();
  node.nmt = NmtState::pre_operational;  // but still in Operation enabled
  run_until_state(DriveState::configuring);
  while (feedback.state == DriveState::configuring) {
    step(10.0F);
    ASSERT_EQ(node.target, 0);
    ASSERT_LT(now, Time{3s});
  }
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(node.state, State::switch_on_disabled);
}

class InvertedDriveTest : public DriveTest {
 protected:
  static DriveConfig<float> inverted() {
    DriveConfig<float> changed = config;
    changed.invert_direction = true;
    return changed;
  }
  InvertedDriveTest() : DriveTest{inverted()} {}
};

TEST_F(InvertedDriveTest, ForceAndPositionChangeSignTogether) {
  enable();
  node.counts = 500;
  node.torque = 20;
  step(10.0F);
  step();
  EXPECT_EQ(drive.counts_at(-500e-6F), -500);
  EXPECT_EQ(drive.position_counts(), -500);
  drive.set_datum_counts(-400);
  EXPECT_FLOAT_EQ(feedback.position_m, -500e-6F);
  EXPECT_FLOAT_EQ(drive.feedback().position_offset_m, -100e-6F);
  EXPECT_FLOAT_EQ(feedback.force_N, -1.0F);
  step(10.0F);
  EXPECT_EQ(node.target, -200);
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
  EXPECT_EQ(feedback.state, DriveState::unusable) << "for good";
  EXPECT_EQ(drive.setup_status(), SetupStatus::force_step_too_coarse);
}

}  // namespace
