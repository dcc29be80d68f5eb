// The whole node for Linux, from its file to its last words, on a simulated bus and in simulated time. What it is on a
// kernel's sockets, under a real scheduler, tests/guest shows.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <set>
#include <string>

#include "breakaway/canopen/sync.hpp"
#include "running_node.hpp"

namespace breakaway::closed_loop {
namespace {

using namespace std::chrono_literals;
using LinuxNode = RunningNode;

::testing::AssertionResult has(const std::string& text, const std::string& part) {
  if (text.find(part) != text.npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "no \"" << part << "\" in:\n" << text;
}

TEST_F(LinuxNode, VisitsItsTargetsInTurnAndEndsAtRestOnTheLast) {
  options_.targets = {"0.02", "-0.01"};
  options_.dwell_s = 0.2;
  options_.duration_s = 3;
  double highest_m = -1;
  const NodeEnd end =
      run(scenarios + "braked_axis.toml", [&] { highest_m = std::max(highest_m, host_->state(0).position_m); });
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_NEAR(highest_m, 0.02, 3e-6);
  EXPECT_NEAR(position_m_[0], -0.01, 3e-6);
  EXPECT_TRUE(has(end.said, "0 missed"));
}

TEST_F(LinuxNode, RunsEveryKindOfAxisThatItsFilesDescribe) {
  options_.duration_s = 6;
  for (const char* name : {"can_axis", "move_axis", "presliding_axis", "belt_axis", "polled_odrive", "three_axes"}) {
    SCOPED_TRACE(name);
    const NodeEnd end = run(scenarios + name + ".toml");
    EXPECT_EQ(end.exit_code, 0) << end.said;
  }
}

TEST_F(LinuxNode, IsRefusedWhereAnotherMasterSpeaks) {
  const std::string said = refusal(scenarios + "braked_axis.toml", [&] {
    static_cast<void>(host_->other_tool().send(canopen::sync_frame(), hal::Time::max()));
  });
  EXPECT_TRUE(has(said, "can0: another master is on the bus (it sends SYNC)"));
}

TEST_F(LinuxNode, NamesTheNodesThatAnswerWhereItsDriveDoesNot) {
  options_.node_id = 5;
  EXPECT_TRUE(has(refusal(scenarios + "braked_axis.toml"), "no drive answers as node 5; these nodes do: 1;"));
  EXPECT_TRUE(has(refusal(scenarios + "polled_odrive.toml"), "no drive answers as node 5; these nodes do: 1;"));
}

TEST_F(LinuxNode, TakesADriveThatAnswersOnlyWhenEverybodyIsAsked) {
  options_.duration_s = 2;
  options_.patience_s = 1;
  bool was_off = false, is_on = false;
  const NodeEnd end = run(scenarios + "braked_axis.toml", [&] {
    if (!was_off) host_->drive(0).power_off(host_->now());
    was_off = true;
    if (is_on || hal::seconds(host_->now()) < 1.3) return;
    host_->drive(0).power_on(host_->now());
    is_on = true;
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
}

// As by SIGSTOP, or where a debugger holds it: nobody was asked anything meanwhile.
TEST_F(LinuxNode, WaitsAsLongForItsDrivesThoughItWasHeldForAnHour) {
  options_.duration_s = 2;
  int woken = 0;
  const NodeEnd end = run(scenarios + "braked_axis.toml", [&] {
    if (++woken != 250) return;
    EXPECT_LT(running_s(), 0) << "its drive is being set up";
    host_->oversleep(3600s);
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
}

// Its certificate is for targets that are given where all of them rest.
TEST_F(LinuxNode, GivesAxesThatPushEachOtherATargetWhereTheyHold) {
  const std::string controller = "max_force_N = 100, position_tolerance_m = 1e-5";
  const std::string file =
      changed("coupled_gantry.toml", controller, controller + ", targets = [{ time_s = 0.05, position_m = 0.01 }]");
  options_.duration_s = 4;
  bool rested_there = false;
  const NodeEnd end = run(file, [&] {
    const sil::AxisState left = host_->state(0);
    rested_there = rested_there || (left.sticking && std::abs(left.position_m) < 2e-5);
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_TRUE(rested_there) << "the first target was given up for the second";
  EXPECT_NEAR(position_m_[0], 0.01, 1.1e-5);
}

TEST_F(LinuxNode, StopsAnAxisOnItsWayWhenItsOperatorEndsIt) {
  options_.targets = {"1"};
  double asked_s = 0, off_s = 0;
  const NodeEnd end = run(scenarios + "braked_axis.toml", [&] {
    at(0.1, [&] {
      EXPECT_GT(std::abs(host_->state(0).velocity_m_s), 0.1) << "it is on its way";
      telemetry_->stop = true;
      asked_s = running_s();
    });
    if (asked_s > 0 && off_s == 0 && !host_->holds_axis(0)) off_s = running_s();
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_TRUE(has(end.said, "stopped"));
  EXPECT_LE(off_s - asked_s, 0.02) << "a quick stop takes a few periods";
}

TEST_F(LinuxNode, NamesABusThatIsOffAndGoesOnAfterTheReset) {
  options_.duration_s = 5;
  bool forced = false;
  const NodeEnd end = run(scenarios + "braked_axis.toml", [&] {
    at(0.1, [&] { host_->port().set_bus_state(hal::BusState::bus_off); });
    at(0.5, [&] { host_->port().set_bus_state(hal::BusState::error_active); });
    // Its drive has missed the node's heartbeat by then.
    forced = forced || makes_force_between(0.3, 1);
    at(1, [&] { telemetry_->reset = true; });
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_EQ(named_, std::set{AxisFault::bus_off});
  EXPECT_FALSE(forced) << "before the reset";
}

TEST_F(LinuxNode, EndsByNameWhenItsDriveIsGone) {
  options_.duration_s = 1;
  for (const char* name : {"braked_axis", "polled_odrive"}) {
    SCOPED_TRACE(name);
    const NodeEnd end =
        run(scenarios + name + ".toml", [&] { at(0.1, [&] { host_->drive(0).power_off(host_->now()); }); });
    EXPECT_EQ(end.exit_code, 1) << end.said;
    EXPECT_EQ(named_, std::set{AxisFault::feedback_stale});
  }
}

TEST_F(LinuxNode, StopsAllAxesWithTheOneWhoseDriveIsGoneAndGoesOnAfterTheReset) {
  options_.duration_s = 6;
  options_.targets = {"0.9,-0.4,-3"};
  const std::string file =
      changed("three_axes.toml", "[axis.drive] # a screw", "[axis.drive]\nencoder = \"absolute\" # a screw");
  bool forced = false;
  const NodeEnd end = run(file, [&] {
    at(0.1, [&] { host_->drive(1).power_off(host_->now()); });
    at(0.4, [&] { host_->drive(1).power_on(host_->now()); });
    forced = forced || makes_force_between(0.2, 2);
    at(2, [&] { telemetry_->reset = true; });
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_EQ(named_, (std::set{AxisFault::feedback_stale, AxisFault::stopped_with_another}));
  EXPECT_FALSE(forced) << "before the reset";
}

TEST_F(LinuxNode, SendsAxesThatPushEachOtherNoFurtherThanTheirCertificateGoes) {
  options_.targets = {"0.9"};
  EXPECT_TRUE(
      has(refusal(scenarios + "coupled_gantry.toml"),
          "axis left would go to its first target from -0.03 m to 0.9 m at once, and [coupling] start_m is 0.03"));
}

TEST_F(LinuxNode, TakesALoadOnABeltFromTargetToTarget) {
  options_.targets = {"0", "0.03", "0"};
  options_.dwell_s = 0.5;
  options_.duration_s = 10;
  const NodeEnd end = run(scenarios + "belt_axis.toml");
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_LE(std::abs(position_m_[0]), 3.205e-4) << "the tolerance of the file, and half a count";
}

// The drive misses the node's heartbeat meanwhile and stops; a command of before is obeyed by nobody.
TEST_F(LinuxNode, DrivesNoAxisAfterAStallUntilItsOperatorHasSeenTheFault) {
  options_.duration_s = 5;
  bool forced = false;
  const NodeEnd end = run(scenarios + "braked_axis.toml", [&] {
    at(0.1, [&] { host_->oversleep(1s); });
    forced = forced || makes_force_between(1.15, 2);
    at(2, [&] { telemetry_->reset = true; });
  });
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_EQ(named_, std::set{AxisFault::emergency});
  EXPECT_FALSE(forced) << "before the reset";
}

TEST_F(LinuxNode, IdentifiesAnAxis) {
  options_.identify = true;
  const NodeEnd end = run(scenarios + "move_axis.toml");
  EXPECT_EQ(end.exit_code, 0) << end.said;
  EXPECT_TRUE(has(end.said, "experiment  complete"));
  EXPECT_TRUE(has(end.said, "latency        1 period"));
}

}  // namespace
}  // namespace breakaway::closed_loop
