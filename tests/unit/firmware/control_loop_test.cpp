// What the loop sends, when, and what it hands on to drive and law.
#include "breakaway/firmware/control_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "control_loop_fixture.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using testing::ControlLoopTest;
using testing::DriveProbe;
using testing::Loop;

TEST_F(ControlLoopTest, SendsCommandsBeforeTheSyncAtWhichTheyAct) {
  probe.wants_acyclic = true;
  step();
  ASSERT_EQ(port.sent.size(), 3U);
  EXPECT_EQ(port.sent[0].id, canopen::rpdo_cob_id(1, 1));
  EXPECT_EQ(port.sent[1].id, canopen::sync_cob_id);
  EXPECT_EQ(port.sent[2].id, canopen::sdo_request_cob_id(1));
  EXPECT_EQ(probe.syncs.back(), now);
}

TEST_F(ControlLoopTest, SyncLeavesAtItsTimeOfThePeriodAndOnlyAfterCommands) {
  loop.sync(now);
  EXPECT_TRUE(port.sent.empty()) << "nothing was commanded";
  EXPECT_FALSE(loop.sync_due());
  probe.wants_acyclic = true;
  for (const hal::Duration late : {0us, 7us, 300us}) {
    now += 1ms;
    port.sent.clear();
    loop.command(now);
    ASSERT_EQ(port.sent.size(), 1U);
    EXPECT_EQ(port.sent[0].id, canopen::rpdo_cob_id(1, 1));
    ASSERT_EQ(loop.sync_due(), now + canopen::sync_offset(1, 1ms, 1'000'000));
    const hal::Time leaves = *loop.sync_due() + late;
    loop.sync(leaves);
    ASSERT_EQ(port.sent.size(), 3U);
    EXPECT_EQ(port.sent[1].id, canopen::sync_cob_id);
    EXPECT_EQ(port.sent[2].id, canopen::sdo_request_cob_id(1));
    EXPECT_EQ(probe.syncs.back(), leaves) << "the drive samples when it comes";
    EXPECT_FALSE(loop.sync_due()) << "it left";
  }
}

TEST_F(ControlLoopTest, WhatIsLateIsStaleAtTheEndOfItsOwnPeriod) {
  probe.wants_acyclic = true;
  loop.command(now += 1ms);
  loop.sync(*loop.sync_due());
  ASSERT_EQ(port.deadlines.size(), 3U);
  for (const hal::Time deadline : port.deadlines) EXPECT_EQ(deadline, now + 1ms);
}

TEST_F(ControlLoopTest, AnAxisThatStopsAsAskedHasNoFaultAndCanBeEnabledAgain) {
  enable();
  loop.request_stop(axis);
  for (const auto state : {hal::DriveState::stopping, hal::DriveState::disabled}) {
    probe.feedback.state = state;
    probe.feedback.fresh = true;
    step();
    EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
    EXPECT_FALSE(loop.status(axis).running);
  }
  enable();
}

TEST_F(ControlLoopTest, GivesForceOnlyToAnEnabledAxis) {
  for (const auto state : {hal::DriveState::configuring, hal::DriveState::disabled, hal::DriveState::enabling,
                           hal::DriveState::stopping, hal::DriveState::fault, hal::DriveState::unusable}) {
    probe.feedback.state = state;
    probe.feedback.fresh = probe.feedback.ever_valid = true;
    step();
  }
  EXPECT_TRUE(probe.commands.empty());
  loop.reset_fault(axis);
  enable();
  probe.feedback.position_offset_m = 2e-4F;
  step();
  EXPECT_FLOAT_EQ(probe.commands.back(), -2e-3F);
}

TEST_F(ControlLoopTest, TellsTheDriveToStopWithinTheCallAndGivesNoMoreForce) {
  enable();
  const auto commands = probe.commands.size();
  loop.request_stop(axis);
  EXPECT_EQ(probe.stops, 1);
  for (int i = 0; i < 10; ++i) step();  // it does not obey
  EXPECT_EQ(probe.commands.size(), commands);
  EXPECT_FALSE(loop.status(axis).running);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
}

TEST_F(ControlLoopTest, GivesNoForceToADriveThatNobodyWantsEnabled) {
  probe.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
  for (int i = 0; i < 10; ++i) step();
  EXPECT_TRUE(probe.commands.empty());
  EXPECT_FALSE(loop.status(axis).running);
  EXPECT_EQ(probe.enables, 0);
}

TEST_F(ControlLoopTest, EnablesOnlyWhatIsWanted) {
  probe.feedback.state = hal::DriveState::disabled;
  step();
  EXPECT_EQ(probe.enables, 0);
  loop.request_enable(axis);
  step();
  EXPECT_EQ(probe.enables, 1);
}

// Counts are modulo 2^32, and the way across the end of the range is the short one.
TEST_F(ControlLoopTest, ATargetAcrossTheEndOfTheRangeIsAsFarAsItIs) {
  constexpr auto highest = std::numeric_limits<std::int32_t>::max();
  constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
  loop.set_target_counts(axis, highest - 9);
  const float before = loop.controller(axis).shifted;
  loop.set_target_counts(axis, lowest + 10);
  EXPECT_EQ(probe.datum, lowest + 10);
  EXPECT_FLOAT_EQ(loop.controller(axis).last_shift, 20e-6F);
  EXPECT_LT(std::abs(loop.controller(axis).shifted - before), 1e-3F);
  loop.set_target_counts(axis, highest);
  EXPECT_FLOAT_EQ(loop.controller(axis).last_shift, -11e-6F);
}

TEST_F(ControlLoopTest, TheErrorAllowedAcrossTheEndOfTheRangeIsThatOfTheTargetChange) {
  auto limits = testing::moderate_limits();
  limits.following_error_m = 0.01F;
  DriveProbe other;
  const auto id = *loop.add_axis({&other, 2}, {}, limits).id;
  loop.set_target_counts(id, std::numeric_limits<std::int32_t>::max());
  loop.request_enable(id);
  other.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
  other.feedback.sample_time = now;
  step();
  ASSERT_TRUE(loop.status(id).running);
  loop.set_target_counts(id, std::numeric_limits<std::int32_t>::min() + 999);
  other.feedback.sample_time = now;
  other.feedback.position_offset_m = -0.001F;
  step();
  EXPECT_EQ(loop.status(id).fault, AxisFault::none);
  other.feedback.sample_time = now;
  other.feedback.position_offset_m = -0.012F;
  step();
  EXPECT_EQ(loop.status(id).fault, AxisFault::following_error);
}

TEST_F(ControlLoopTest, TellsTheLawWhatForceTheDriveHas) {
  enable();
  EXPECT_EQ(loop.controller(axis).limit_N, 50);
}

TEST_F(ControlLoopTest, MovesDatumAndLawWithTheTarget) {
  loop.set_target_counts(axis, 5000);
  EXPECT_EQ(probe.datum, 5000);
  EXPECT_FLOAT_EQ(loop.controller(axis).shifted, 5e-3F);
  loop.set_target_m(axis, -1e-3F);
  EXPECT_EQ(probe.datum, -1000);
  EXPECT_NEAR(loop.controller(axis).shifted, -1e-3F, 1e-9);
  loop.set_target_m(axis, 1e30F);
  EXPECT_GT(probe.datum, 2147480000) << "saturates";
}

TEST_F(ControlLoopTest, TellsTheLawWhenASampleIsMissing) {
  enable();
  probe.feedback.position_offset_m = 1e-4F;
  probe.feedback.fresh = false;
  step();
  EXPECT_EQ(probe.commands.back(), 0.0F);
}

TEST_F(ControlLoopTest, CountsFramesThatThePortRefused) {
  port.full = true;
  step();
  EXPECT_EQ(loop.refused_frames(), 2U);
}

TEST_F(ControlLoopTest, HandsADriveItsFramesWithinABound) {
  port.to_receive.push_back({{.id = canopen::tpdo_cob_id(1, 2)}, {}});
  step();
  EXPECT_EQ(probe.frames, 0) << "another node's";
  for (int i = 0; i < 300; ++i) port.to_receive.push_back({{.id = canopen::tpdo_cob_id(1, 1)}, {}});
  step();
  EXPECT_EQ(probe.frames, 256);
  step();
  EXPECT_EQ(probe.frames, 300);
}

TEST_F(ControlLoopTest, MakesTheDriveForTheScaleOfTheController) {
  EXPECT_EQ(loop.drive(axis).scale.encoder_resolution_m, loop.controller(axis).encoder_resolution_m());
  EXPECT_EQ(loop.drive(axis).scale.max_force_N, loop.controller(axis).max_force_N());
}

TEST_F(ControlLoopTest, SendsItsOwnHeartbeatInPlaceOfAnAcyclicFrame) {
  Loop beating{port, {.network = {.period = 1ms, .node_id = 100, .heartbeat_period = 10ms}}};
  probe.wants_acyclic = true;
  ASSERT_EQ(beating.add_axis({&probe, 1}, {}, {}).error, AxisError::none);
  int heartbeats = 0;
  for (int i = 1; i <= 100; ++i) {
    port.sent.clear();
    beating.step(hal::Time{i * 1ms});
    heartbeats += port.sent.back().id == canopen::heartbeat_cob_id(100);
  }
  EXPECT_EQ(heartbeats, 10);
}

}  // namespace
}  // namespace breakaway::firmware
