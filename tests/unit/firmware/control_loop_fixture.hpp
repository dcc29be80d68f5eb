// A loop of one axis against a drive and a port of the test's own, so that only the loop is under test.
#pragma once

#include <gtest/gtest.h>

#include "breakaway/firmware/control_loop.hpp"
#include "fake_axis.hpp"

namespace breakaway::firmware::testing {

class ControlLoopTest : public ::testing::Test {
 protected:
  FakePort port;
  DriveProbe probe;
  Loop loop{port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
  Loop::AxisId axis = *loop.add_axis({&probe, 1}, {}, testing::moderate_limits()).id;
  hal::Time now{};

  void step() {
    now += 1ms;
    probe.feedback.sample_time = now - 1ms;
    port.sent.clear();
    loop.step(now);
  }
  void enable() {
    loop.request_enable(axis);
    probe.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
    step();
    ASSERT_TRUE(loop.status(axis).running);
  }
  // The drive obeyed its stop, and may be told to enable again.
  void reset_once_without_force() {
    probe.feedback.state = hal::DriveState::disabled;
    step();
    EXPECT_TRUE(loop.reset_fault(axis));
  }
  void run_for(hal::Duration duration) {
    for (const hal::Time end = now + duration; now < end;) step();
  }
};

}  // namespace breakaway::firmware::testing
