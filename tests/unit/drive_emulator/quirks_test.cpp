#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

using cia402::State;

class DriveQuirksTest : public DriveBench {
 protected:
  EmulatorConfig config = bench_config();
};

TEST_F(DriveQuirksTest, ShowsNoModeForAWhileAfterARequest) {
  config.quirks.mode_display_delay = milliseconds{50};
  start(config);
  enable();
  target_torque(500);
  EXPECT_EQ(sdo({0x40, 0x61, 0x60, 0, 0, 0, 0, 0}).at(4), 0xFFU);
  EXPECT_EQ(force_N(), 0);
  for (int i = 0; i < 5; ++i) {  // asking again must not start the wait anew
    set_torque_mode();
    run(milliseconds{9});
  }
  EXPECT_EQ(sdo({0x40, 0x61, 0x60, 0, 0, 0, 0, 0}).at(4), 10U);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
}

TEST_F(DriveQuirksTest, HasNoTorqueMode) {
  config.supported_modes = 0x81;  // profile position, cyclic position
  start(config);
  EXPECT_EQ(abort_code({0x2F, 0x60, 0x60, 0, 10, 0, 0, 0}), 0x06090030U);
  expect_written({0x2F, 0x60, 0x60, 0, 8, 0, 0, 0});
  target_torque(500);
  for (const unsigned word : {0x06U, 0x0FU}) controlword(word);
  EXPECT_EQ(drive->state(), State::operation_enabled);
  EXPECT_EQ(force_N(), 0);
}

TEST_F(DriveQuirksTest, RefusesEveryTransferAtFirst) {
  config.quirks.sdo_busy = milliseconds{50};
  start(config);
  EXPECT_EQ(abort_code({0x40, 0x00, 0x10, 0, 0, 0, 0, 0}), 0x08000022U);
  EXPECT_EQ(abort_code({0x2B, 0x17, 0x10, 0, 100, 0, 0, 0}), 0x08000022U);
  run(milliseconds{50});
  EXPECT_EQ(sdo({0x40, 0x17, 0x10, 0, 0, 0, 0, 0}).at(4), 0U) << "nothing was written";
}

TEST_F(DriveQuirksTest, RefusesToEnableWithoutAMode) {
  config.quirks.needs_mode_to_enable = true;
  start(config);
  for (const unsigned word : {0x06U, 0x07U, 0x0FU}) controlword(word);
  EXPECT_EQ(drive->state(), State::switched_on);
  set_torque_mode();
  controlword(0x0F);
  EXPECT_EQ(drive->state(), State::operation_enabled);
}

TEST_F(DriveQuirksTest, MissesControlwordsThatChangeTooFast) {
  config.quirks.min_controlword_interval = milliseconds{2};
  start(config);
  drive->trip_fault(0x2310, now);
  run(milliseconds{5});
  send(0x605, {0x2B, 0x40, 0x60, 0, 0x06, 0, 0, 0});
  run(milliseconds{1});
  send(0x605, {0x2B, 0x40, 0x60, 0, 0x80, 0, 0, 0});
  EXPECT_EQ(drive->state(), State::fault);
  run(milliseconds{1});
  send(0x605, {0x2B, 0x40, 0x60, 0, 0x80, 0, 0, 0});
  EXPECT_EQ(drive->state(), State::switch_on_disabled);
}

TEST_F(DriveQuirksTest, FallsBackToSwitchedOnWithoutAWord) {
  config.quirks.silent_drop_at = hal::Time{milliseconds{100}};
  start(config);
  enable_cyclic();
  cycle(0x0F, 500);
  cycle(0x0F, 500);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  while (now < hal::Time{milliseconds{110}}) cycle(0x0F, 500);
  EXPECT_EQ(drive->state(), State::switched_on);
  EXPECT_EQ(force_N(), 0);
  EXPECT_EQ(count(0x085), 0U);
  cycle(0x07, 0);
  for (int i = 0; i < 2; ++i) cycle(0x0F, 0);
  sync();
  EXPECT_EQ(drive->state(), State::operation_enabled);
}

TEST_F(DriveQuirksTest, InformsByEmcyWhileItWorksAndKnowsOfNoError) {
  config.quirks.informs_with = 0xFF01;
  config.quirks.informs_every = milliseconds{10};
  start(config);
  enable_cyclic();
  sent.clear();
  for (int i = 0; i < 25; ++i) cycle(0x0F, 500);
  const std::size_t told = count(0x085);
  EXPECT_GE(told, 2U);
  EXPECT_LE(told, 3U);
  EXPECT_EQ(last(0x085), (Bytes{0x01, 0xFF, 0, 0, 0, 0, 0, 0}));
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  EXPECT_EQ(drive->objects().get({0x1001, 0}), 0);
  EXPECT_EQ(drive->objects().get({0x1003, 0}), 0);
  EXPECT_EQ(drive->objects().get({0x603F, 0}), 0);
  drive->trip_fault(0x2310, now);
  sent.clear();
  run(milliseconds{100});
  EXPECT_EQ(count(0x085), 0U) << "it does not work any more";
}

TEST_F(DriveQuirksTest, AlarmsWhenSyncIsLate) {
  config.quirks.sync_alarm_periods = 2;
  start(config);
  expect_written({0x23, 0x06, 0x10, 0, 0xE8, 0x03, 0, 0});  // 1000 us
  enable_cyclic();
  for (int i = 0; i < 5; ++i) cycle(0x0F, 500);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  run(microseconds{1999});  // 2.999 periods after the last SYNC
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  run(microseconds{1});
  EXPECT_EQ(force_N(), 0);
  EXPECT_EQ(last(0x085), (Bytes{0x00, 0x87, 0x21, 0, 0, 0, 0, 0}));
}

TEST_F(DriveQuirksTest, ScalesTheTargetByMaxTorque) {
  config.quirks.torque_relative_to_max = true;
  start(config);
  enable();
  target_torque(500);
  EXPECT_DOUBLE_EQ(force_N(), 15.0);  // half of 3000 per mille of 10 N
}

TEST_F(DriveQuirksTest, ScalesItsPositionByItsFactorGroup) {
  config.quirks.feed_constant = 2500;
  start(config);
  EXPECT_EQ(sdo({0x40, 0x8F, 0x60, 1, 0, 0, 0, 0}), (Bytes{0x43, 0x8F, 0x60, 1, 0x10, 0x27, 0, 0}));
  EXPECT_EQ(sdo({0x40, 0x92, 0x60, 1, 0, 0, 0, 0}), (Bytes{0x43, 0x92, 0x60, 1, 0xC4, 0x09, 0, 0}));
  mechanism.position = -4 * 1000 * config.encoder_resolution_m;
  EXPECT_EQ(sdo({0x40, 0x64, 0x60, 0, 0, 0, 0, 0}), (Bytes{0x43, 0x64, 0x60, 0, 0x18, 0xFC, 0xFF, 0xFF}));
  expect_written({0x23, 0x91, 0x60, 1, 2, 0, 0, 0});
  EXPECT_EQ(sdo({0x40, 0x64, 0x60, 0, 0, 0, 0, 0}), (Bytes{0x43, 0x64, 0x60, 0, 0x0C, 0xFE, 0xFF, 0xFF}));
}

TEST_F(DriveQuirksTest, DoesNotGoBeyondAStateThatIsInhibitedAndFallsBackToIt) {
  start(config);
  enable();
  target_torque(500);
  ASSERT_DOUBLE_EQ(force_N(), 5.0);
  drive->inhibit_beyond(State::switch_on_disabled, now);
  EXPECT_EQ(drive->state(), State::switch_on_disabled);
  EXPECT_EQ(force_N(), 0);
  for (const unsigned word : {0x06U, 0x07U, 0x0FU}) controlword(word);
  EXPECT_EQ(drive->state(), State::switch_on_disabled);
  drive->inhibit_beyond(State::switched_on, now);
  for (const unsigned word : {0x06U, 0x07U, 0x0FU}) controlword(word);
  EXPECT_EQ(drive->state(), State::switched_on);
  drive->inhibit_beyond({}, now);
  controlword(0x0F);
  EXPECT_EQ(drive->state(), State::operation_enabled);
}

TEST_F(DriveQuirksTest, GivesNoMoreThanASupplyThatDroppedAllows) {
  start(config);
  enable();
  target_torque(500);
  drive->limit_peak_force(2, now);
  EXPECT_DOUBLE_EQ(force_N(), 2.0);
  EXPECT_DOUBLE_EQ(drive->largest_force_N(now), 5.0) << "as it was before";
}

TEST_F(DriveQuirksTest, AcceptsMillisecondsOnlyForTheInterpolationPeriod) {
  start(config);
  expect_written({0x2F, 0xC2, 0x60, 2, 0xFC, 0, 0, 0});
  config.quirks.interpolation_in_ms_only = true;
  start(config);
  expect_written({0x2F, 0xC2, 0x60, 2, 0xFD, 0, 0, 0});
  EXPECT_EQ(abort_code({0x2F, 0xC2, 0x60, 2, 0xFC, 0, 0, 0}), 0x06090032U);
}

}  // namespace
}  // namespace breakaway::drive_emulator
