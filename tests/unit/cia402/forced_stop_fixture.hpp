// A drive that was told to stop and keeps its force, for the tests of what is done to it.
#pragma once

#include <algorithm>

#include "drive_fixture.hpp"

namespace breakaway::test {

using breakaway::cia402::ForcedStop;
using breakaway::cia402::StateMachine;

class ForcedStopTest : public DriveTest {
 protected:
  explicit ForcedStopTest(const DriveConfig<float>& drive_config = config) : DriveTest{drive_config} {}

  // A drive that gives force and no longer hears its RPDO.
  void enable_and_go_deaf() {
    enable();
    step(10.0F);
    node.follows_controlword = false;
  }
  // One that was then forced to a stop, and is held.
  void enable_and_be_forced() {
    enable_and_go_deaf();
    drive.request_stop();
    run_until([&] { return feedback.stop_not_obeyed; });
    run_until([&] { return !feedback.stop_not_obeyed; });
  }
  bool without_force() const { return cia402::is_without_force(node.state); }
  Duration time_until_without_force(Duration limit = 10s) {
    const Time begin = now;
    run_until([&] { return without_force(); }, limit);
    return now - begin;
  }
  bool was_told(NmtCommand command) const {
    return std::find(node.commands.begin(), node.commands.end(), command) != node.commands.end();
  }
  // After a reset it is set up anew, seen disabled, and can be enabled again when it hears its RPDO again.
  void expect_recovery() {
    node.follows_controlword = true;
    run_until([&] { return without_force() && feedback.state != DriveState::stopping; });
    drive.reset_fault();
    step();
    run_until_state(DriveState::disabled);
    EXPECT_FALSE(feedback.stop_not_obeyed);
    EXPECT_EQ(drive.setup_status(), SetupStatus::ready);
    run_for(100ms);
    EXPECT_EQ(feedback.state, DriveState::disabled) << "not enabled without a new request";
    drive.request_enable();
    run_until_state(DriveState::enabled);
  }
};

}  // namespace breakaway::test
