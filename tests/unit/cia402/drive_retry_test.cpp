// Lost answers of a set-up, and what a drive says of itself that makes its position another than the encoder's.
#include <algorithm>

#include "drive_fixture.hpp"

namespace breakaway::test::drive_retry {
namespace {

using breakaway::cia402::DriveNode;

class DriveRetryTest : public DriveTest {
 protected:
  void boot_again() {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    node.boot();
    deliver();
    step();
  }
  bool was_reset() const {
    return std::find(node.commands.begin(), node.commands.end(), NmtCommand::reset_communication) !=
           node.commands.end();
  }
};

// At each moment of the set-up, up to the mode of operation, which is told last.
TEST_F(DriveRetryTest, EveryRequestIsMadeThreeTimesBeforeTheNodeIsGivenUp) {
  int moments = 0;
  for (Duration onset{};; onset += 1ms) {
    for (const unsigned lost : {2U, 3U}) {
      boot_again();
      run_for(onset);
      if (!node.written.empty() && node.written.back() == ScriptedDrive::key(0x6060, 0)) {
        EXPECT_GT(moments, 50);
        return;
      }
      node.sdo_requests_lost = lost;
      bool gave_up = false;
      run_until([&] {
        gave_up = gave_up || drive.setup_status() == SetupStatus::no_answer;
        return gave_up || feedback.state == DriveState::disabled;
      });
      EXPECT_EQ(gave_up, lost == DriveNode::sdo_attempts) << lost << " lost at " << onset / 1ms << " ms";
      EXPECT_FALSE(was_reset()) << "nobody has waited for it yet";
      run_until_state(DriveState::disabled);
      EXPECT_EQ(drive.setup_status(), SetupStatus::ready) << "it is set up in the end";
    }
    ++moments;
  }
}

// Two losses of one request do not add up with those of another.
TEST_F(DriveRetryTest, EachRequestHasItsOwnAttempts) {
  boot_again();
  run_for(5ms);
  for (int request = 0; request < 4; ++request) {
    node.sdo_requests_lost = 2;
    run_until([&] { return node.sdo_requests_lost == 0; });
    const ObjectAddress object = drive.setup_object();
    run_until([&] { return drive.setup_object() != object; });
    EXPECT_NE(drive.setup_status(), SetupStatus::no_answer) << request;
  }
  run_until_state(DriveState::disabled);
  EXPECT_FALSE(was_reset());
}

// Its heartbeats were supervised already: what is waited for has none to lose.
TEST_F(DriveRetryTest, ANodeThatIsGivenUpHasLostNoHeartbeat) {
  boot_again();
  const auto was_written = [&](std::uint16_t index) {
    return std::find(node.written.begin(), node.written.end(), ScriptedDrive::key(index, 0)) != node.written.end();
  };
  run_until([&] { return was_written(0x1017); });
  run_for(5ms);
  node.silent = true;
  run_until([&] { return drive.setup_status() == SetupStatus::no_answer; });
  run_for(400ms);
  EXPECT_FALSE(drive.heartbeat_lost());
}

// As by a drive that still starts. An object that need not be there is not passed over meanwhile.
TEST_F(DriveRetryTest, ARefusalThatMayPassIsAskedAgainUntilItDoes) {
  for (const std::uint16_t index : {std::uint16_t{0x6076}, std::uint16_t{0x607E}}) {
    for (const SdoAbort code : {SdoAbort::timeout, SdoAbort::out_of_memory, SdoAbort::cannot_store,
                                SdoAbort::local_control, SdoAbort::device_state}) {
      boot_again();
      node.objects[ScriptedDrive::key(0x607E, 0)] = 0;
      node.refused[ScriptedDrive::key(index, 0)] = code;
      run_for(2s);
      EXPECT_EQ(drive.setup_status(), SetupStatus::in_progress);
      EXPECT_EQ(drive.setup_object().index, index) << to_string(code);
      node.refused.clear();
      run_for(500ms);
      EXPECT_EQ(drive.setup_status(), SetupStatus::ready) << to_string(code);
    }
  }
}

TEST_F(DriveRetryTest, ARefusalThatStaysIsOneForGoodAfterThreeSeconds) {
  boot_again();
  node.refused[ScriptedDrive::key(0x6076, 0)] = SdoAbort::device_state;
  run_for(2900ms);
  EXPECT_EQ(drive.setup_status(), SetupStatus::in_progress);
  run_for(500ms);
  EXPECT_EQ(drive.setup_status(), SetupStatus::object_refused);
  EXPECT_EQ(drive.setup_abort_code(), SdoAbort::device_state);
}

TEST_F(DriveRetryTest, ANodeThatAnswersLateIsGivenTheTimeThatItNeedsAndIsNotWhenItIsGone) {
  boot_again();
  run_for(5ms);
  EXPECT_EQ(drive.extra_setup_time(), 0ms);
  node.sdo_requests_lost = 1;
  run_for(80ms);
  ASSERT_EQ(drive.setup_status(), SetupStatus::in_progress);
  EXPECT_GT(drive.extra_setup_time(), 10s) << "for every object six times what an answer may take";
  node.silent = true;
  run_for(5s);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_answer);
  EXPECT_EQ(drive.extra_setup_time(), 0ms);
}

// At each moment between two questions for the mode of operation.
TEST_F(DriveRetryTest, ANodeThatLeavesOperationalIsStartedAnewBeforeItIsAskedForItsModeAgain) {
  const auto asks_for_the_mode = [this] {
    return std::any_of(sent.begin(), sent.end(), [](const CanFrame& frame) {
      return frame.id == sdo_request_cob_id(node_id) && frame.data[0] == 0x40 && frame.data[1] == 0x61 &&
             frame.data[2] == 0x60;
    });
  };
  for (Duration onset{}; onset < DriveNode::poll_time + 5ms; onset += 1ms) {
    boot_again();
    node.objects[ScriptedDrive::key(0x6061, 0)] = 0;
    run_until([&] { return asks_for_the_mode(); });
    run_for(onset);
    node.nmt = NmtState::pre_operational;
    node.ignores_start = true;
    node.heartbeat();
    deliver();
    for (int period = 0; period < 50; ++period) {
      step();
      ASSERT_FALSE(asks_for_the_mode()) << "left after " << onset / 1ms << " ms";
    }
    node.ignores_start = false;
    node.objects[ScriptedDrive::key(0x6061, 0)] = 10;
    run_until_state(DriveState::disabled);
  }
}

struct Position {
  std::uint16_t index;
  std::uint8_t subindex;
  std::uint32_t value;
  SetupStatus status;
};

TEST_F(DriveRetryTest, APositionThatIsReversedOrWrapsIsRefusedByName) {
  for (const Position& p :
       {Position{0x607E, 0, 0x80, SetupStatus::position_reversed},
        Position{0x607E, 0, 0xC0, SetupStatus::position_reversed}, Position{0x607B, 1, 1, SetupStatus::position_wraps},
        Position{0x607B, 1, 0xFFFFFFFF, SetupStatus::position_wraps},
        Position{0x607B, 2, 3600, SetupStatus::position_wraps}}) {
    boot_again();
    node.objects[ScriptedDrive::key(p.index, p.subindex)] = p.value;
    run_until_state(DriveState::unusable);
    EXPECT_EQ(drive.setup_status(), p.status);
    EXPECT_EQ(drive.setup_object(), (ObjectAddress{p.index, p.subindex}));
  }
  for (const Position& p :
       {Position{0x607E, 0, 0x40, SetupStatus::ready}, Position{0x607E, 0, 0x20, SetupStatus::ready},
        Position{0x607E, 0, 0x01, SetupStatus::ready}, Position{0x607B, 1, 0, SetupStatus::ready},
        Position{0x607B, 1, 0x80000000, SetupStatus::ready}, Position{0x607B, 2, 0x7FFFFFFF, SetupStatus::ready}}) {
    boot_again();
    node.objects[ScriptedDrive::key(p.index, p.subindex)] = p.value;
    run_until_state(DriveState::disabled);
    EXPECT_EQ(drive.setup_status(), p.status);
  }
}

// With one end at 0 the position wraps at half of what 32 bits count.
TEST_F(DriveRetryTest, ARangeOfHalfTheCountsIsRefusedByName) {
  const auto status_with = [&](std::uint32_t lowest, std::uint32_t highest, DriveState state) {
    boot_again();
    node.objects[ScriptedDrive::key(0x607B, 1)] = lowest;
    node.objects[ScriptedDrive::key(0x607B, 2)] = highest;
    run_until_state(state);
    return drive.setup_status();
  };
  EXPECT_EQ(status_with(0, 0x7FFFFFFF, DriveState::unusable), SetupStatus::position_wraps);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x607B, 2}));
  EXPECT_EQ(status_with(0x80000000, 0, DriveState::unusable), SetupStatus::position_wraps);
  EXPECT_EQ(status_with(0x80000000, 0x7FFFFFFF, DriveState::disabled), SetupStatus::ready);
  EXPECT_EQ(status_with(0, 0, DriveState::disabled), SetupStatus::ready);
}

}  // namespace
}  // namespace breakaway::test::drive_retry
