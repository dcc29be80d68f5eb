// How an axis with an incremental encoder gets its zero.
#include <gtest/gtest.h>

#include <optional>

#include "breakaway/canopen/bytes.hpp"
#include "breakaway/cia402/objects.hpp"
#include "drive_fixture.hpp"

namespace breakaway::test {
namespace {

using cia402::Home;

constexpr std::uint32_t key(std::uint16_t index, std::uint8_t subindex = 0) {
  return ScriptedDrive::key(index, subindex);
}
constexpr std::uint16_t home_found = 0x1400, home_error = 0x2000;  // bits of the statusword
constexpr std::uint16_t seek_word = 0x1F;

DriveConfig<float> with(const cia402::HomingConfig& homing) {
  DriveConfig<float> told = config;
  told.homing = homing;
  return told;
}

class HomingTest : public DriveTest {
 protected:
  explicit HomingTest(const DriveConfig<float>& told = with({.home = Home::by_drive,
                                                             .position_counts = 500,
                                                             .method = 17,
                                                             .search_counts_s = 10'000,
                                                             .zero_counts_s = 1'000,
                                                             .acceleration_counts_s2 = 50'000,
                                                             .timeout = 5s}))
      : DriveTest{told} {
    node.objects[key(0x6502)] = 1U << 9 | 1U << 5;
    node.shows_the_mode_at_once = true;
    node.objects.erase(key(0x6061));
    node.objects[key(0x6061)] = 0;
    node.counts = 77'000;
  }
  std::uint32_t mode() { return node.objects[key(0x6060)] & 0xFFU; }
  void seek() {
    set_up();
    drive.request_enable();
    run_until([&] { return node.controlword == seek_word; });
    ASSERT_EQ(feedback.state, DriveState::homing);
    ASSERT_EQ(mode(), 6U);
  }
  void find_home() {
    node.counts = 500;
    node.extra_status = home_found;
    run_until_state(DriveState::disabled);
  }
};

TEST_F(HomingTest, TheSetUpTellsTheDriveHow) {
  set_up();
  EXPECT_EQ(node.value_of(0x6098, 0), 17U);
  EXPECT_EQ(node.value_of(0x6099, 1), 10'000U);
  EXPECT_EQ(node.value_of(0x6099, 2), 1'000U);
  EXPECT_EQ(node.value_of(0x609A, 0), 50'000U);
  EXPECT_EQ(node.value_of(0x607C, 0), 500U);
  EXPECT_EQ(mode(), 10U);
}

// Some vendors' methods, which are below 0, press against a stop until nothing moves.
TEST(HomingMethods, BelowZeroLookForAStop) {
  for (const int method : {-128, -4, -1, 0, 1, 17, 37}) {
    const auto told = with({.home = Home::by_drive, .method = static_cast<std::int8_t>(method)});
    EXPECT_EQ((Drive<float>{told, network, scale}.homes_against_a_stop()), method < 0) << method;
  }
}

TEST_F(HomingTest, LeadsTheDriveToItsHomeAndBackToTorque) {
  seek();
  for (int period = 0; period < 200; ++period) {
    step(30.0F);
    ASSERT_EQ(node.controlword, seek_word) << "it is not told to start over and over";
    ASSERT_EQ(node.target, 0);
    ASSERT_EQ(feedback.state, DriveState::homing);
  }
  find_home();
  EXPECT_EQ(mode(), 10U);
  EXPECT_FALSE(feedback.homing_failed);
  drive.set_datum_counts(500);
  run_for(10ms);
  EXPECT_EQ(drive.position_counts(), 500);
  EXPECT_EQ(feedback.position_offset_m, 0.0F);
  drive.request_enable();
  run_until_state(DriveState::enabled);
  EXPECT_EQ(mode(), 10U) << "it has its home";
  step(30.0F);
  EXPECT_EQ(node.target, 600);
}

TEST_F(HomingTest, TheJumpToTheHomeIsNoTravel) {
  seek();
  float travel_m = 0;
  node.counts = -1'000'000;
  node.extra_status = home_found;
  run_until([&] {
    travel_m += feedback.state == DriveState::disabled ? feedback.travel_m : 0;
    return feedback.state == DriveState::disabled;
  });
  run_for(10ms);
  EXPECT_EQ(travel_m, 0.0F);
}

TEST_F(HomingTest, AHomeThatWasFoundBeforeIsNotTaken) {
  set_up();
  node.extra_status = home_found;
  drive.request_enable();
  run_until([&] { return node.controlword == seek_word; });
  run_for(40ms);
  EXPECT_EQ(feedback.state, DriveState::homing);
  node.extra_status = 0;
  run_for(500ms);
  EXPECT_EQ(node.controlword, seek_word);
  find_home();
  EXPECT_FALSE(feedback.homing_failed);
}

TEST_F(HomingTest, AnErrorIsToldUntilAResetAndThenItIsTriedAgain) {
  seek();
  node.extra_status = home_error;
  run_until([&] { return feedback.homing_failed; }, 100ms);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(mode(), 10U);
  EXPECT_TRUE(feedback.homing_failed);
  node.extra_status = 0;
  drive.reset_fault();
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  EXPECT_FALSE(feedback.homing_failed);
  drive.request_enable();
  run_until([&] { return node.controlword == seek_word; });
  find_home();
  EXPECT_FALSE(feedback.homing_failed);
}

TEST_F(HomingTest, OneThatDoesNotEndHasFailed) {
  seek();
  run_for(4900ms);
  EXPECT_FALSE(feedback.homing_failed);
  EXPECT_EQ(feedback.state, DriveState::homing);
  run_until([&] { return feedback.homing_failed; }, 300ms);
  run_until_state(DriveState::disabled);
}

TEST_F(HomingTest, AStopIsNoFailureAndTheNextEnableSeeksAgain) {
  seek();
  drive.request_stop();
  step();
  EXPECT_NE(node.controlword & 0x0FU, 0x0FU);
  run_until_state(DriveState::disabled);
  EXPECT_FALSE(feedback.homing_failed);
  EXPECT_EQ(mode(), 10U);
  drive.request_enable();
  run_until([&] { return node.controlword == seek_word; });
}

TEST_F(HomingTest, AFaultOfTheDriveEndsIt) {
  seek();
  node.state = State::fault;
  run_until([&] { return feedback.homing_failed; }, 100ms);
  EXPECT_TRUE(feedback.faulty);
  EXPECT_EQ(feedback.state, DriveState::stopping) << "it had force a moment ago";
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(mode(), 10U);
}

TEST_F(HomingTest, ADriveThatRebootsMeanwhileHasNoHome) {
  seek();
  node.boot();
  deliver();
  run_until_state(DriveState::disabled);
  EXPECT_TRUE(drive.reference_lost());
  drive.reset_fault();
  EXPECT_FALSE(drive.reference_lost());
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  drive.request_enable();
  run_until([&] { return node.controlword == seek_word; });
}

TEST_F(HomingTest, AReferenceThatIsGivenTakesItsPlace) {
  set_up();
  drive.set_reference_counts(12);
  drive.request_enable();
  run_until_state(DriveState::enabled);
  EXPECT_EQ(mode(), 10U);
}

TEST_F(HomingTest, ADriveThatDoesNotObeyTheStopAfterItIsForced) {
  seek();
  node.follows_controlword = false;
  node.extra_status = home_error;
  run_until([&] { return feedback.stop_not_obeyed; }, 2s);
  run_until([&] { return node.state != State::operation_enabled; }, 2s);
}

TEST_F(HomingTest, ADriveWithoutHomingIsRefusedByName) {
  for (const std::uint32_t modes : {1U << 9, 1U << 9 | 0x1DFU}) {
    node.objects[key(0x6502)] = modes;
    node.boot();
    deliver();
    step();
    run_until_state(DriveState::unusable);
    EXPECT_EQ(drive.setup_status(), SetupStatus::no_homing_mode);
    EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x6502, 0}));
  }
}

TEST_F(HomingTest, AHomeThatIsFoundTakesThePlaceOfAReferenceThatWasGiven) {
  set_up();
  drive.set_reference_counts(12);
  node.boot();
  deliver();
  step();
  run_until_state(DriveState::disabled);
  drive.reset_fault();
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  drive.request_enable();
  run_until([&] { return node.controlword == seek_word; });
  find_home();
  EXPECT_EQ(drive.position_counts(), 500);
}

// The fault has a code, which is asked for afterwards.
TEST_F(HomingTest, AFaultIsFollowedByTheModeOfTorqueBeforeAnythingElse) {
  seek();
  node.written.clear();
  node.state = State::fault;
  std::optional<CanFrame> first;
  const Time begin = now;
  run_until([&] {
    for (const CanFrame& frame : sent)
      if (!first && frame.id == sdo_request_cob_id(node_id)) first = frame;
    return first.has_value();
  });
  EXPECT_EQ(breakaway::canopen::load_little_endian<std::uint16_t>(first->data, 1), 0x6060);
  EXPECT_EQ((now - begin) / 1ms, 4) << "a sample that shows it, the stop, and the mode";
  run_for(3ms);
  EXPECT_EQ(mode(), 10U);
}

TEST_F(HomingTest, ADriveThatNeverShowsTheModeIsRefusedByName) {
  set_up();
  node.shows_the_mode_at_once = false;
  drive.request_enable();
  run_until([&] { return feedback.state == DriveState::unusable; }, 15s);
  EXPECT_EQ(drive.setup_status(), SetupStatus::no_homing_mode);
}

TEST_F(HomingTest, AMethodThatTheDriveLacksIsRefusedByNameWithItsObject) {
  node.refused[key(0x6098)] = SdoAbort::invalid_value;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  EXPECT_EQ(drive.setup_status(), SetupStatus::object_refused);
  EXPECT_EQ(drive.setup_object(), (ObjectAddress{0x6098, 0}));
}

class InvertedHomingTest : public HomingTest {
 protected:
  InvertedHomingTest() : HomingTest{inverted()} {}
  static DriveConfig<float> inverted() {
    DriveConfig<float> told = with({.home = Home::by_drive, .position_counts = 500});
    told.invert_direction = true;
    return told;
  }
};
TEST_F(InvertedHomingTest, HomeIsInTheAxisDirection) {
  seek();
  EXPECT_EQ(node.value_of(0x607C, 0), 0U - 500U);
  node.counts = -500;
  node.extra_status = home_found;
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.position_counts(), 500);
}

class SetZeroTest : public HomingTest {
 protected:
  SetZeroTest() : HomingTest{with({.home = Home::here, .position_counts = -40})} {}
};
TEST_F(SetZeroTest, TheAxisStandsAtHomeWhenItIsEnabledFirst) {
  set_up();
  EXPECT_EQ(drive.position_counts(), 77'000);
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), -40);
  run_until_state(DriveState::enabled);
  node.counts += 10;
  run_for(2ms);
  EXPECT_EQ(drive.position_counts(), -30);
  drive.request_stop();
  run_until_state(DriveState::disabled);
  drive.request_enable();
  run_until_state(DriveState::enabled);
  EXPECT_EQ(drive.position_counts(), -30) << "only once";
  EXPECT_FALSE(node.value_of(0x6098, 0)) << "the drive is told nothing of it";
}

TEST_F(SetZeroTest, AfterARebootItIsThereOnlyIfAResetSaysSo) {
  set_up();
  drive.request_enable();
  run_until_state(DriveState::enabled);
  node.boot();
  node.counts = 3;
  deliver();
  run_until_state(DriveState::disabled);
  EXPECT_TRUE(drive.reference_lost());
  drive.reset_fault();
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  EXPECT_FALSE(drive.reference_lost());
  drive.request_enable();
  EXPECT_EQ(drive.position_counts(), -40);
}

}  // namespace
}  // namespace breakaway::test
