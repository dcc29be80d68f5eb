// Ties and defaults: when a sample counts as late, double or missing, and what is so unless told otherwise.
#include <gtest/gtest.h>

#include <limits>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/cia402/homing.hpp"
#include "breakaway/cia402/position_factor.hpp"
#include "drive_fixture.hpp"

namespace breakaway::test::drive_edges {
namespace {

using cia402::Home;
using cia402::Homing;
using cia402::HomingConfig;
using cia402::InterpolationPeriod;
using cia402::PositionFactor;

CanFrame sample(std::int32_t counts) {
  CanFrame frame{.id = tpdo_cob_id(1, node_id), .size = 8, .data = {0x40, 0x02}};
  breakaway::canopen::store_little_endian(frame.data, counts, 2);
  return frame;
}

using DriveEdgesTest = DriveTest;

// By half a period a loop may wake late and read it then.
TEST_F(DriveEdgesTest, ASampleBelongsToTheSyncOfThePeriodBeforeIt) {
  set_up();
  const Time sync = now + 5ms;
  struct Row {
    Duration after;
    bool answers;
  };
  for (const Row& row : {Row{-1ns, false}, Row{0ns, true}, Row{300us, true}, Row{1ms, true}, Row{1500us, true},
                         Row{1500us + 1ns, false}}) {
    drive.on_frame({.frame = breakaway::canopen::sync_frame(), .time = sync});
    drive.on_frame({.frame = sample(7), .time = sync + row.after});
    EXPECT_EQ(drive.feedback().sample_time, row.answers ? sync : sync + row.after) << row.after.count();
  }
}

TEST_F(DriveEdgesTest, TwoSamplesAPeriodAreAConflictWhenTheyComeFiveTimesInARow) {
  set_up();
  const auto step_with = [&](int samples) {
    for (int i = 1; i < samples; ++i) drive.on_frame({.frame = sample(1), .time = now});
    step();  // which brings one more
  };
  for (int n = 0; n < 4; ++n) step_with(2);
  EXPECT_FALSE(drive.node_id_conflict());
  step_with(1);
  for (int n = 0; n < 4; ++n) step_with(3);
  EXPECT_FALSE(drive.node_id_conflict()) << "counted anew";
  step_with(2);
  EXPECT_TRUE(drive.node_id_conflict());
  for (int n = 0; n < 10; ++n) step_with(2);
  EXPECT_TRUE(drive.node_id_conflict()) << "as long as it lasts";
  step_with(1);
  EXPECT_FALSE(drive.node_id_conflict());
}

TEST_F(DriveEdgesTest, ADriveWithoutForceThatAnswersNoSyncForTwentyMillisecondsIsSetUpAnew) {
  set_up();
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  node.sends_tpdo = false;
  run_for(20ms);
  node.sends_tpdo = true;
  run_for(5ms);
  EXPECT_EQ(feedback.state, DriveState::disabled) << "it answered in time";
  node.sends_tpdo = false;
  run_for(21ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  step();
  EXPECT_EQ(feedback.state, DriveState::configuring);
}

TEST_F(DriveEdgesTest, ShowsTheStatusAndTheStateOfTheDrive) {
  EXPECT_EQ(drive.cia402_state(), std::nullopt);
  EXPECT_EQ(drive.statusword(), 0);
  EXPECT_EQ(drive.rating().rated_current_mA + drive.rating().rated_torque_mNm, 0U);
  EXPECT_EQ(drive.rating().found_max_torque_per_mille, 0);
  EXPECT_EQ(drive.rating().max_torque_per_mille, 1000);
  EXPECT_EQ(drive.max_force_N(), 60.0F) << "the axis' own before the drive's is known";
  enable();
  EXPECT_EQ(drive.statusword() & 0x6F, 0x27);
  EXPECT_EQ(drive.cia402_state(), State::operation_enabled);
}

TEST_F(DriveEdgesTest, BeforeAnySampleThereIsNone) {
  feedback = drive.feedback();
  EXPECT_FALSE(feedback.fresh || feedback.ever_valid);
  EXPECT_EQ(feedback.position_m, 0.0F);
  EXPECT_EQ(feedback.position_offset_m, 0.0F);
  EXPECT_EQ(feedback.travel_m, 0.0F);
  EXPECT_EQ(feedback.force_N, 0.0F);
  EXPECT_FALSE(drive.node_id_conflict());
  node.counts = 1000;
  set_up();
  EXPECT_EQ(drive.position_counts(), 1000) << "the axis counts as the drive does";
}

TEST_F(DriveEdgesTest, TheFirstCommandHasNoForce) {
  enable();
  EXPECT_EQ(node.target, 0);
}

// One whose heartbeat another tool has switched off. Its samples come all the same.
TEST_F(DriveEdgesTest, ADriveWithoutForceThatLosesItsHeartbeatIsSetUpAnew) {
  set_up();
  node.objects[ScriptedDrive::key(0x1017, 0)] = 0;
  run_for(140ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  run_for(120ms);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(node.value_of(0x1017, 0), 100U);
}

class HomeHereTest : public DriveTest {
 protected:
  HomeHereTest() : DriveTest{homing_here()} {}
  static DriveConfig<float> homing_here() {
    DriveConfig<float> told = config;
    told.homing = {.home = Home::here, .position_counts = -40};
    return told;
  }
};
TEST_F(HomeHereTest, NothingIsSaidOfADriveBeforeItsFirstSample) {
  node.sends_tpdo = false;
  node.boot();
  deliver();
  run_until([&] { return drive.setup_status() == SetupStatus::ready; });
  EXPECT_EQ(feedback.force_N, 0.0F);
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), 0) << "nobody knows what is to become -40";
}

class OneQuantumTest : public DriveTest {
 protected:
  OneQuantumTest() : DriveTest{config, {.encoder_resolution_m = 1e-6F, .max_force_N = 0.07F}} {}
};
TEST_F(OneQuantumTest, ALimitBetweenQuantaIsTheOneBelow) {
  set_up();
  EXPECT_FLOAT_EQ(drive.max_force_N(), 0.05F);
}

TEST(DriveEdges, ThePlaceNextToTheLowestIsACountOfItsOwn) {
  const Drive<double> drive{{.node_id = node_id, .force_per_torque_N_per_Nm = 50}, network, {1, 60}};
  EXPECT_EQ(drive.counts_at(-2147483647.0), -2147483647);
  EXPECT_EQ(drive.counts_at(-2147483648.0), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ(drive.counts_at(2147483647.0), std::numeric_limits<std::int32_t>::max());
}

TEST(DriveNodeEdges, WhatCannotBeADriveIsRefusedAndToldNothing) {
  DriveConfig<float> bad = config;
  bad.node_id = 0;
  cia402::DriveNode node{bad, network, 60.0F};
  EXPECT_EQ(node.phase(), cia402::SetupPhase::refused);
  EXPECT_EQ(node.status(), SetupStatus::config_invalid);
  CanFrame frame;
  node.force_stop(Time{1s});
  node.update(Time{1s});
  EXPECT_FALSE(node.next_frame(frame, Time{1s}));
  EXPECT_EQ(node.phase(), cia402::SetupPhase::refused);
}

TEST(DriveNodeEdges, AStopThatIsForcedAlreadyDoesNotBeginAnew) {
  cia402::DriveNode node{config, network, 60.0F};
  Time now{};
  int to_pre_operational = 0;
  for (int ms = 0; ms < 250; ++ms) {
    node.force_stop(now += 1ms);
    node.update(now);
    CanFrame frame;
    if (node.next_frame(frame, now)) to_pre_operational += frame.id == breakaway::canopen::nmt_cob_id ? 1 : 0;
  }
  EXPECT_EQ(to_pre_operational, 1) << "100 ms after it began";
}

TEST(SetupStepDefaults, AreARequiredReadOfNoObject) {
  const cia402::SetupStep step;
  EXPECT_EQ(step.kind, cia402::SetupStep::Kind::read);
  EXPECT_FALSE(step.optional);
  EXPECT_EQ(step.index + step.subindex + step.size, 0);
  EXPECT_EQ(step.value, 0U);
}

TEST(DriveDefaults, AreThoseOfTheDocumentation) {
  const DriveConfig<float> drive{};
  EXPECT_EQ(drive.heartbeat_period, 100ms);
  EXPECT_EQ(drive.heartbeat_timeout, 250ms);
  EXPECT_EQ(drive.sdo_timeout, 50ms);
  EXPECT_FALSE(drive.user_position_unit || drive.invert_direction || drive.absolute_encoder);
  EXPECT_EQ(drive.homing.home, Home::none);
  EXPECT_EQ(drive.homing.method, 37) << "the axis stands at home";
  EXPECT_EQ(drive.homing.position_counts, 0);
  EXPECT_EQ(drive.homing.search_counts_s + drive.homing.zero_counts_s + drive.homing.acceleration_counts_s2, 0U);
  EXPECT_EQ(drive.homing.timeout, 60s);
  EXPECT_EQ(InterpolationPeriod{}, (InterpolationPeriod{0, 0}));
  EXPECT_EQ(NetworkConfig{}.heartbeat_period, 50ms);
}

TEST(InterpolationPeriodEdges, EveryDecadeReachesFromOneTo255) {
  using cia402::interpolation_period;
  EXPECT_EQ(interpolation_period(7us), (InterpolationPeriod{7, -6}));
  EXPECT_EQ(interpolation_period(255us), (InterpolationPeriod{255, -6}));
  EXPECT_EQ(interpolation_period(255ms), (InterpolationPeriod{255, -3}));
  EXPECT_EQ(interpolation_period(2550ms), (InterpolationPeriod{255, -2}));
  EXPECT_EQ(interpolation_period(2560ms), std::nullopt);
  EXPECT_EQ(interpolation_period(25500ms), (InterpolationPeriod{255, -1}));
  EXPECT_EQ(interpolation_period(26s), (InterpolationPeriod{26, 0}));
  EXPECT_EQ(interpolation_period(255s), (InterpolationPeriod{255, 0}));
  EXPECT_EQ(interpolation_period(256s), std::nullopt);
  EXPECT_EQ(interpolation_period(2550s), std::nullopt) << "units of ten seconds are none of the object's";
}

TEST(PositionFactorEdges, OneIsTakenForOneToAMillionth) {
  const auto factor_of = [](std::uint32_t feed) {
    PositionFactor factor;
    factor.note({0x608F, 1}, 10'000'000);
    factor.note({0x6092, 1}, feed);
    return factor;
  };
  for (const int off : {-15, -5, 0, 5, 15}) {
    const PositionFactor factor = factor_of(static_cast<std::uint32_t>(10'000'000 + off));
    EXPECT_EQ(factor.is_one_to_one(), off > -10 && off < 10) << off;
    EXPECT_EQ(factor.is_finer_than_encoder(), off > 10) << off;
  }
}

constexpr std::uint16_t found = 0x1400, error = 0x2000;
constexpr Time begin{5s};

TEST(HomingEdges, ADriveIsBelievedFiftyMillisecondsAfterItFollows) {
  Homing homing{HomingConfig{.home = Home::by_drive, .timeout = 1s}};
  for (const std::uint16_t status : {found, error}) {
    homing.begin();
    homing.on_selected(begin);
    EXPECT_FALSE(homing.seek(status, true, false, begin + 200ms)) << "it does not follow yet";
    EXPECT_FALSE(homing.seek(status, true, true, begin + 300ms));
    EXPECT_FALSE(homing.seek(status, true, true, begin + 350ms - 1ns));
    EXPECT_TRUE(homing.seek(status, true, true, begin + 350ms));
    EXPECT_EQ(homing.failed(), status == error);
    EXPECT_EQ(homing.on_stopped(), status == found);
    homing.on_returned();
    EXPECT_FALSE(homing.active());
  }
  homing.begin();
  EXPECT_FALSE(homing.failed()) << "a new attempt";
  homing.on_selected(begin);
  EXPECT_FALSE(homing.seek(found, true, true, begin)) << "the time counts from its own start";
  homing.stop();
  EXPECT_FALSE(homing.on_stopped()) << "nothing was found";
}

TEST(HomingEdges, ADriveHasTheWholeTimeOfTheFile) {
  Homing homing{HomingConfig{.home = Home::by_drive, .timeout = 1s}};
  EXPECT_FALSE(homing.failed());
  homing.begin();
  homing.on_selected(begin);
  EXPECT_FALSE(homing.seek(0, true, true, begin + 1s));
  EXPECT_TRUE(homing.seek(0, true, true, begin + 1s + 1ns));
  EXPECT_TRUE(homing.failed());
  homing.begin();
  homing.stop();
  EXPECT_FALSE(homing.on_stopped());
  EXPECT_FALSE(homing.failed()) << "a stop that was asked for is no failure";
}

TEST(HomingEdges, ADriveThatIsLostAfterAnAttemptLeavesItFailed) {
  Homing homing{HomingConfig{.home = Home::by_drive, .timeout = 1s}};
  homing.begin();
  homing.on_selected(begin);
  ASSERT_TRUE(homing.seek(0, false, false, begin));
  homing.on_stopped();
  homing.on_returned();
  homing.lose();
  EXPECT_TRUE(homing.failed());
  homing.begin();
  homing.on_selected(begin);
  homing.lose();
  EXPECT_FALSE(homing.active());
  EXPECT_TRUE(homing.failed()) << "or it would be energised again and again without a name";
}

}  // namespace
}  // namespace breakaway::test::drive_edges
