// When a node is told what, and what a drive is told again, at each moment of a set-up.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "drive_fixture.hpp"

namespace breakaway::test::drive_timeline {
namespace {

bool is_nmt(const CanFrame& frame, NmtCommand command) {
  return frame.id == breakaway::canopen::nmt_cob_id && frame.data[0] == static_cast<std::uint8_t>(command);
}
bool is_sdo(const CanFrame& frame, std::uint16_t index) {
  return frame.id == sdo_request_cob_id(node_id) && frame.data[0] != 0x80 &&
         breakaway::canopen::load_little_endian<std::uint16_t>(frame.data, 1) == index;
}

class TimelineTest : public DriveTest {
 protected:
  explicit TimelineTest(const DriveConfig<float>& told = config) : DriveTest{told} {}

  // The milliseconds, of so many from now on, in which a frame left that is meant.
  template <class IsMeant>
  std::vector<int> times(int milliseconds, const IsMeant& is_meant) {
    std::vector<int> found;
    for (int ms = 1; ms <= milliseconds; ++ms) {
      step();
      if (std::any_of(sent.begin(), sent.end(), is_meant)) found.push_back(ms);
    }
    return found;
  }
  std::vector<int> times_of(int milliseconds, NmtCommand command) {
    return times(milliseconds, [command](const CanFrame& frame) { return is_nmt(frame, command); });
  }
  std::vector<int> times_of(int milliseconds, std::uint16_t index) {
    return times(milliseconds, [index](const CanFrame& frame) { return is_sdo(frame, index); });
  }
  void boot() {
    node.boot();
    deliver();
  }
  void expect_that_it_works() {
    run_until([&] { return feedback.state == DriveState::disabled; }, 8s);
    EXPECT_EQ(drive.setup_status(), SetupStatus::ready);
    EXPECT_EQ(drive.setup_object(), ObjectAddress{});
    drive.request_enable();
    run_until_state(DriveState::enabled);
    EXPECT_EQ(drive.rating().rated_current_mA, 5000U);
    EXPECT_EQ(drive.rating().max_torque_per_mille, 1200U);
  }
};

std::vector<int> differences(const std::vector<int>& times) {
  std::vector<int> found;
  for (std::size_t i = 1; i < times.size(); ++i) found.push_back(times[i] - times[i - 1]);
  return found;
}

TEST_F(TimelineTest, ASilentNodeIsResetAfterItsHeartbeatTimeoutAndThenAfterTwiceAsLongEachTimeUpToEightSeconds) {
  node.silent = true;
  EXPECT_EQ(times_of(31000, NmtCommand::reset_communication), (std::vector<int>{251, 2251, 6251, 14251, 22251, 30251}));
}

TEST_F(TimelineTest, ASilentNodeIsToldToSwitchOffOnceAndAfterEachResetUntilItAnswers) {
  node.silent = true;
  EXPECT_EQ(times_of(251, 0x6040), std::vector<int>{1});
  const auto asked = times_of(1999, 0x6040);
  EXPECT_GE(asked.size(), 35U) << "a transfer has 50 ms for its answer";
  EXPECT_LE(asked.size(), 40U);
}

// Some nodes say no boot-up, and have no heartbeat before it is told to them.
TEST_F(TimelineTest, ANodeThatOnlyAnswersIsSetUpWhenItsTimeToBootIsOver) {
  for (const bool refuses : {false, true}) {
    for (const unsigned lost : {0U, 11U}) {
      drive = Drive<float>{config, network, scale};
      node = ScriptedDrive{node_id};
      node.boots_silently = true;
      node.boot();
      if (refuses) node.refused[ScriptedDrive::key(0x6040, 0)] = SdoAbort::no_such_object;
      EXPECT_TRUE(times_of(250, NmtCommand::reset_communication).empty());
      EXPECT_EQ(times_of(1, NmtCommand::reset_communication).size(), 1U);
      node.sdo_requests_lost = lost;
      EXPECT_TRUE(times_of(1999, NmtCommand::enter_pre_operational).empty());
      EXPECT_EQ(times_of(1, NmtCommand::enter_pre_operational).size(), 1U);
      EXPECT_EQ(times_of(20, std::uint16_t{0x1000}).size(), 1U);
      expect_that_it_works();
      EXPECT_EQ(drive.reboots(), 0U);
    }
  }
}

TEST_F(TimelineTest, ANodeThatDoesNotStartIsToldAgainAndThenSetUpAnew) {
  node.ignores_start = true;
  boot();
  run_until([&] { return std::ranges::count(node.commands, NmtCommand::start) == 1; });
  EXPECT_EQ(drive.setup_status(), SetupStatus::in_progress);
  EXPECT_EQ(drive.setup_object(), ObjectAddress{}) << "the set-up stands nowhere";
  EXPECT_EQ(times_of(1990, NmtCommand::start), (std::vector<int>{250, 500, 750, 1000, 1250, 1500, 1750}));
  EXPECT_EQ(times_of(200, std::uint16_t{0x1000}).size(), 1U);
  node.ignores_start = false;
  expect_that_it_works();
}

constexpr DriveConfig<float> slow_heart{
    .node_id = node_id, .force_per_torque_N_per_Nm = 50.0F, .heartbeat_timeout = 3s};
class SlowHeartTest : public TimelineTest {
 protected:
  SlowHeartTest() : TimelineTest{slow_heart} {}
};

TEST_F(SlowHeartTest, ANodeHasTwiceItsHeartbeatTimeoutToStart) {
  node.ignores_start = true;
  boot();
  run_until([&] { return std::ranges::count(node.commands, NmtCommand::start) == 1; });
  EXPECT_EQ(times_of(5990, NmtCommand::start), std::vector<int>{3000});
  EXPECT_EQ(times_of(200, std::uint16_t{0x1000}).size(), 1U);
}

TEST_F(TimelineTest, TheModeIsAskedForEveryTwentyMillisecondsAndToldEveryHalfSecond) {
  node.objects[ScriptedDrive::key(0x6061, 0)] = 0xFF;
  boot();
  run_until([&] { return node.nmt == NmtState::operational && !sent.empty() && is_sdo(sent.back(), 0x6061); });
  const Time begin = now;
  const auto polls = times(1100, [](const CanFrame& frame) { return is_sdo(frame, 0x6061) || is_sdo(frame, 0x6060); });
  EXPECT_GE(polls.size(), 50U);
  for (const int interval : differences(polls)) EXPECT_EQ(interval, 20);
  const auto requests = times_of(2000, std::uint16_t{0x6060});
  EXPECT_EQ(requests.size(), 4U);
  for (const int interval : differences(requests)) EXPECT_EQ(interval, 500);
  run_until([&] { return feedback.state == DriveState::unusable; }, 9s);
  EXPECT_NEAR(static_cast<double>((now - begin) / 1ms), 10'000, 30);
  EXPECT_EQ(drive.setup_status(), SetupStatus::mode_refused);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x6061, 0}));
}

TEST_F(TimelineTest, TheErrorCodeIsReadOnceForEachFaultThatNoEmergencyTellsOf) {
  enable();
  for (const unsigned code : {0x2310U, 0x7305U, 0x8611U}) {
    EXPECT_EQ(feedback.fault_code, 0);
    node.objects[ScriptedDrive::key(0x603F, 0)] = code;
    node.state = State::fault;
    EXPECT_EQ(times_of(100, std::uint16_t{0x603F}).size(), 1U);
    EXPECT_EQ(feedback.fault_code, code);
    EXPECT_EQ(drive.setup_object(), ObjectAddress{}) << "it is none of the set-up's";
    drive.request_stop();
    step();
    drive.reset_fault();
    expect_that_it_works();
  }
  node.emergency(0x4210);
  node.state = State::fault;
  EXPECT_TRUE(times_of(100, std::uint16_t{0x603F}).empty());
  EXPECT_EQ(feedback.fault_code, 0x4210);
  drive.request_stop();
  step();
  drive.reset_fault();
  expect_that_it_works();
  node.state = State::fault;
  EXPECT_EQ(times_of(100, std::uint16_t{0x603F}).size(), 1U) << "the emergency went with its fault";
}

constexpr DriveConfig<float> talkative{.node_id = node_id,
                                       .force_per_torque_N_per_Nm = 50.0F,
                                       .emcy_information = {.first = {0x4200, 0xFF01}, .last = {0x42FF, 0xFF01}}};
class TalkativeTest : public TimelineTest {
 protected:
  TalkativeTest() : TimelineTest{talkative} {}
};

TEST_F(TalkativeTest, InformationIsShownAndIsNoError) {
  enable();
  node.emergency(0xFF01);
  run_for(2ms);
  EXPECT_EQ(feedback.state, DriveState::enabled);
  EXPECT_EQ(drive.take_emergency(), 0);
  EXPECT_EQ(drive.last_error_code(), 0);
  EXPECT_EQ(drive.last_emcy().code, 0xFF01) << "for people to read";
  node.emergency(0x8110);
  node.emergency(0x4210);
  run_for(2ms);
  EXPECT_EQ(drive.take_emergency(), 0x8110);
  EXPECT_EQ(drive.last_error_code(), 0x8110);
  EXPECT_EQ(drive.last_emcy().code, 0x4210);
}

TEST_F(TalkativeTest, TheErrorCodeOfAFaultIsReadWhereOnlyInformationCame) {
  enable();
  node.objects[ScriptedDrive::key(0x603F, 0)] = 0x2310;
  node.emergency(0x4210);
  node.state = State::fault;
  EXPECT_EQ(times_of(100, std::uint16_t{0x603F}).size(), 1U);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, 0x2310);
}

TEST_F(TalkativeTest, AFaultIsNamedByTheErrorThatCameBeforeInformation) {
  enable();
  node.emergency(0x7305);
  node.emergency(0xFF01);
  node.state = State::fault;
  EXPECT_TRUE(times_of(100, std::uint16_t{0x603F}).empty());
  EXPECT_EQ(feedback.fault_code, 0x7305);
}

TEST_F(TimelineTest, ADriveIsFaultyFromTheReactionToItsFaultUntilItIsReset) {
  enable();
  EXPECT_FALSE(feedback.faulty);
  node.state = State::fault_reaction_active;
  run_for(2ms);
  EXPECT_EQ(feedback.state, DriveState::stopping);
  EXPECT_TRUE(feedback.faulty);
  node.state = State::fault;
  run_for(2ms);
  EXPECT_TRUE(feedback.faulty);
  drive.request_stop();
  step();
  drive.reset_fault();
  expect_that_it_works();
  EXPECT_FALSE(feedback.faulty);
  node.state = State::quick_stop_active;
  run_for(2ms);
  EXPECT_FALSE(feedback.faulty);
}

// What was told to a drive that is no longer the same one goes no further: a bus that was full may still hold it.
TEST_F(TimelineTest, ACommandThatWasNotSentIsForgottenWithWhatItWasFor) {
  const auto pass = [this](int periods) {
    for (int i = 0; i < periods; ++i) drive.update(now += 1ms);
  };
  const auto next_is = [this](NmtCommand command) {
    CanFrame frame;
    return drive.next_acyclic_frame(frame, now) && is_nmt(frame, command);
  };
  pass(251);  // a node that says nothing is to be reset
  drive.on_frame({.frame = breakaway::canopen::heartbeat_frame(NmtState::pre_operational, node_id), .time = now});
  pass(1);
  EXPECT_FALSE(next_is(NmtCommand::reset_communication)) << "it is there";

  drive = Drive<float>{config, network, scale};
  node.ignores_start = true;
  boot();
  run_until([&] { return std::ranges::count(node.commands, NmtCommand::start) == 1; });
  const auto object = [this] { return drive.setup_object(); };
  ASSERT_EQ(object(), ObjectAddress{});
  pass(2000);
  EXPECT_FALSE(next_is(NmtCommand::start)) << "it is set up anew first";
}

TEST_F(TimelineTest, AnErrorCodeIsNotReadOnceItsFaultIsGone) {
  enable();
  node.state = State::fault;
  run_for(2ms);
  boot();
  EXPECT_TRUE(times_of(300, std::uint16_t{0x603F}).empty()) << "it booted before it was asked";
  expect_that_it_works();
  drive.request_stop();
  node.sdo_requests_lost = 1;
  for (const State state : {State::fault, State::switch_on_disabled, State::fault, State::switch_on_disabled}) {
    node.state = state;
    run_for(5ms);
  }
  EXPECT_TRUE(times_of(200, std::uint16_t{0x603F}).empty()) << "one was asked for and lost";
}

// While its mode is asked for, at each moment of it.
TEST_F(TimelineTest, ANodeThatStopsOperatingIsSwitchedOffAndLookedAtAtOnceAndToldNoMode) {
  for (int moment = 0; moment < 25; ++moment) {
    for (const unsigned lost : {0U, 1U}) {
      drive = Drive<float>{config, network, scale};
      node = ScriptedDrive{node_id};
      node.objects[ScriptedDrive::key(0x6061, 0)] = 0xFF;
      boot();
      run_until([&] { return !sent.empty() && is_sdo(sent.back(), 0x6061); });
      run_for(moment * 1ms);
      node.sdo_requests_lost = lost;
      run_until([&] { return node.sdo_requests_lost == 0; });
      node.ignores_start = true;
      node.nmt = NmtState::pre_operational;
      node.heartbeat();
      deliver();
      EXPECT_FALSE(times_of(4, std::uint16_t{0x6041}).empty()) << moment << " ms, " << lost << " lost";
      EXPECT_EQ(node.objects.at(ScriptedDrive::key(0x6040, 0)), 0U);
      EXPECT_TRUE(
          times(100, [](const CanFrame& frame) { return is_sdo(frame, 0x6061) || is_sdo(frame, 0x6060); }).empty())
          << moment << " ms, " << lost << " lost";
    }
  }
}

TEST_F(TimelineTest, ANodeThatOperatesAgainIsAskedForItsModeAtOnce) {
  node.objects[ScriptedDrive::key(0x6061, 0)] = 0xFF;
  boot();
  run_until([&] { return !sent.empty() && is_sdo(sent.back(), 0x6061); });
  node.nmt = NmtState::pre_operational;
  node.heartbeat();
  deliver();
  run_until([&] { return node.nmt == NmtState::operational; });
  node.heartbeat();
  deliver();
  EXPECT_FALSE(times_of(3, std::uint16_t{0x6061}).empty());
}

// Lost requests shift the questions against the ten seconds, so that an answer comes at their very end.
constexpr DriveConfig<float> odd_patience{.node_id = node_id, .force_per_torque_N_per_Nm = 50.0F, .sdo_timeout = 49ms};
TEST_F(TimelineTest, ANodeHasTenWholeSecondsToTakeItsMode) {
  for (unsigned lost = 0; lost < 20; ++lost) {
    drive = Drive<float>{odd_patience, network, scale};
    node = ScriptedDrive{node_id};
    node.objects[ScriptedDrive::key(0x6061, 0)] = 0xFF;
    boot();
    run_until([&] { return !sent.empty() && is_sdo(sent.back(), 0x6061); });
    const Time begin = now - 1ms;  // a period before, it was seen to operate
    node.sdo_requests_lost = lost;
    run_until([&] { return feedback.state == DriveState::unusable; }, 15s);
    EXPECT_GT(now - begin, 10s) << lost;
    EXPECT_LE(now - begin, 10s + 55ms) << lost << ": a question follows each request";
  }
}

TEST_F(TimelineTest, ARefusalThatMayPassIsTakenThirtyTimesInEachSetUp) {
  const auto refuse_for = [this](Duration duration) {
    boot();
    node.refused[ScriptedDrive::key(0x6076, 0)] = SdoAbort::device_state;
    const auto asked = times_of(static_cast<int>(duration / 1ms), std::uint16_t{0x6076});
    node.refused.clear();
    return asked.size();
  };
  for (int round = 0; round < 3; ++round) {
    refuse_for(2s);
    EXPECT_EQ(drive.setup_status(), SetupStatus::in_progress) << round;
    run_until_state(DriveState::disabled);
  }
  EXPECT_EQ(refuse_for(5s), 31U);
  EXPECT_EQ(drive.setup_status(), SetupStatus::object_refused);
}

// What disturbs a set-up at any moment leaves nothing of it behind.
enum class Disturbance { reset, boot, silence, pre_operational };

class DisturbedSetup : public TimelineTest, public testing::WithParamInterface<Disturbance> {};

TEST_P(DisturbedSetup, EndsWithADriveThatWorks) {
  for (int moment = 0; moment < 75; ++moment) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    boot();
    run_for(moment * 1ms);
    switch (GetParam()) {
      case Disturbance::reset:
        drive.reset_fault();
        break;
      case Disturbance::boot:
        boot();
        break;
      case Disturbance::silence:
        node.silent = true;
        run_for(400ms);
        node.silent = false;
        break;
      case Disturbance::pre_operational:
        node.nmt = NmtState::pre_operational;
        break;
    }
    expect_that_it_works();
    const bool booted = GetParam() == Disturbance::boot || GetParam() == Disturbance::silence;
    if (!booted) {
      EXPECT_EQ(drive.rating().found_max_torque_per_mille, 2000U) << "as it was before it was lowered";
    }
    EXPECT_FALSE(testing::Test::HasFailure()) << "disturbed after " << moment << " ms";
    if (testing::Test::HasFailure()) return;
  }
}
INSTANTIATE_TEST_SUITE_P(By, DisturbedSetup,
                         testing::Values(Disturbance::reset, Disturbance::boot, Disturbance::silence,
                                         Disturbance::pre_operational));

}  // namespace
}  // namespace breakaway::test::drive_timeline
