#include <limits>

#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

class SynchronousPdoTest : public DriveBench {};

TEST_F(SynchronousPdoTest, ACommandActsWithTheNextSync) {
  start();
  enable_cyclic();
  sync();
  run(microseconds{300});
  rpdo(0x0F, 1000);
  run(microseconds{699});
  EXPECT_EQ(force_N(), 0);
  run(microseconds{1});
  sync();
  EXPECT_DOUBLE_EQ(force_N(), 10.0);
  EXPECT_DOUBLE_EQ(drive->force().start_s, hal::seconds(now));
}

TEST_F(SynchronousPdoTest, OfTwoCommandsBeforeASyncTheLaterOneActs) {
  start();
  enable_cyclic();
  rpdo(0x0F, 1000);
  rpdo(0x0F, 200);
  sync();
  EXPECT_DOUBLE_EQ(force_N(), 2.0);
}

TEST_F(SynchronousPdoTest, ALostCommandHoldsTheForceForAnotherPeriod) {
  start();
  enable_cyclic();
  cycle(0x0F, 1000);
  sync();
  run(milliseconds{1});  // the zero that should have come is lost
  sync();
  EXPECT_DOUBLE_EQ(force_N(), 10.0);
}

TEST_F(SynchronousPdoTest, ImpulseOfAPulseIsForceTimesSyncDistance) {
  start();
  enable_cyclic();
  cycle(0x0F, 1000);
  mechanism.impulse_Ns = 0;
  cycle(0x0F, 0);  // 10 N from this SYNC to the next
  sync();
  run(milliseconds{5});
  drive->advance_mechanism_to(now);
  EXPECT_NEAR(mechanism.impulse_Ns, 10.0 * 1e-3, 1e-15);  // rounding of the times only
}

TEST_F(SynchronousPdoTest, AnswersASyncWithWhatWasTrueAtIt) {
  start();
  enable_cyclic();
  cycle(0x0F, -300);
  mechanism.position = 1234.4e-6;
  sync();
  mechanism.position = 1.0;  // between SYNC and transmission; must not show
  run(microseconds{20});
  // 1237h: Operation enabled, voltage, remote, follows the command. Torque 0: sampled before the new command acts.
  EXPECT_EQ(last(0x185), (Bytes{0x37, 0x12, 0xD2, 0x04, 0, 0, 0, 0}));
  mechanism.position = -1e-6;
  run(microseconds{980});
  sync();
  run(microseconds{20});
  EXPECT_EQ(last(0x185), (Bytes{0x37, 0x12, 0xFF, 0xFF, 0xFF, 0xFF, 0xD4, 0xFE}));
}

TEST_F(SynchronousPdoTest, SendsWithEveryNthSync) {
  start();
  configure_cyclic_torque();
  for (const unsigned type : {1U, 3U, 240U}) {
    expect_written({0x2F, 0x00, 0x18, 2, type, 0, 0, 0});
    sent.clear();
    for (unsigned i = 0; i < 2 * type; ++i) cycle(0x06, 0);
    EXPECT_EQ(count(0x185), 2U) << type;
  }
}

TEST_F(SynchronousPdoTest, TypeZeroIsSentWithTheSyncAfterAChangeOnly) {
  start();
  configure_cyclic_torque();
  expect_written({0x2F, 0x00, 0x18, 2, 0, 0, 0, 0});
  for (int i = 0; i < 3; ++i) cycle(0x00, 0);
  sent.clear();
  for (int i = 0; i < 3; ++i) cycle(0x00, 0);
  EXPECT_EQ(count(0x185), 0U);
  for (int i = 0; i < 3; ++i) cycle(0x06, 0);
  EXPECT_EQ(count(0x185), 1U);
}

TEST_F(SynchronousPdoTest, EventDrivenPdosActAtOnceAndTellChanges) {
  start();
  send(0x000, {0x01, 5});  // power-on mapping: RPDO1 6040h, TPDO1 6041h, both type 255
  run(microseconds{20});
  EXPECT_EQ(last(0x185), (Bytes{0x50, 0x02}));
  sent.clear();
  send(0x205, {0x06, 0x00});
  EXPECT_EQ(drive->state(), cia402::State::ready_to_switch_on);
  run(microseconds{20});
  EXPECT_EQ(last(0x185), (Bytes{0x31, 0x02}));
  run(milliseconds{100});
  EXPECT_EQ(count(0x185), 1U);
}

TEST_F(SynchronousPdoTest, EventTimerRepeatsAndInhibitTimeHoldsBack) {
  start();
  expect_written({0x23, 0x00, 0x18, 1, 0x85, 0x01, 0x00, 0x80});
  expect_written({0x2B, 0x00, 0x18, 3, 50, 0, 0, 0});  // 5 ms
  expect_written({0x2B, 0x00, 0x18, 5, 20, 0, 0, 0});  // 20 ms
  expect_written({0x23, 0x00, 0x18, 1, 0x85, 0x01, 0x00, 0x00});
  send(0x000, {0x01, 5});
  run(milliseconds{100});
  EXPECT_EQ(count(0x185), 5U);  // at 0, 20, ... 80 ms; that of 100 ms still has its delay to wait
  run(milliseconds{1});
  sent.clear();
  const hal::Time event = now;
  send(0x205, {0x06, 0x00});
  run(milliseconds{10});
  ASSERT_EQ(count(0x185), 1U);
  EXPECT_EQ(sent[0].at, event + milliseconds{4} + microseconds{20});
}

TEST_F(SynchronousPdoTest, RefusesAShortPdoAndUsesTheMappedBytesOfALongOne) {
  start();
  enable_cyclic();
  send(0x205, {0x0F, 0x00, 0xE8});
  EXPECT_EQ(last(0x085), (Bytes{0x10, 0x82, 0x11, 0, 0, 0, 0, 0}));
  cycle(0x0F, 0);
  EXPECT_EQ(last(0x085), (Bytes{0x00, 0x00, 0x00, 0, 0, 0, 0, 0})) << "told when it is over";
  sync();
  EXPECT_EQ(force_N(), 0);
  send(0x205, {0x0F, 0x00, 0xE8, 0x03, 0xAA});
  EXPECT_EQ(last(0x085), (Bytes{0x20, 0x82, 0x11, 0, 0, 0, 0, 0}));
  sync();
  EXPECT_DOUBLE_EQ(force_N(), 10.0);
}

TEST_F(SynchronousPdoTest, ReportsASyncWithData) {
  start();
  enable_cyclic();
  rpdo(0x0F, 1000);
  send(0x080, {1});
  EXPECT_EQ(last(0x085), (Bytes{0x40, 0x82, 0x11, 0, 0, 0, 0, 0}));
  EXPECT_EQ(force_N(), 0);
}

TEST_F(SynchronousPdoTest, DropsCommandsOutsideTheSyncWindow) {
  start();
  enable_cyclic();
  expect_written({0x23, 0x07, 0x10, 0, 0x90, 0x01, 0, 0});  // 400 us
  cycle(0x0F, 1000);                                        // comes after 500 us
  sync();
  EXPECT_EQ(force_N(), 0);
  run(microseconds{400});
  rpdo(0x0F, 1000);
  sync();
  EXPECT_DOUBLE_EQ(force_N(), 10.0);
}

TEST_F(SynchronousPdoTest, SetsItsDelayWithinTheRangeAndRepeatsItForASeed) {
  EmulatorConfig config = bench_config();
  config.min_tpdo_delay = microseconds{100};
  config.max_tpdo_delay = milliseconds{1};
  std::vector<hal::Duration> first_run;
  for (int repeat = 0; repeat < 2; ++repeat) {
    now = hal::Time{};
    start(config);
    configure_cyclic_torque();
    std::vector<hal::Duration> delays;
    for (int i = 0; i < 200; ++i) {
      sent.clear();
      const hal::Time synced = now;
      sync();
      run(milliseconds{2});
      for (const SentFrame& entry : sent)
        if (entry.frame.id == 0x185) delays.push_back(entry.at - synced);
    }
    ASSERT_EQ(delays.size(), 200U);
    const auto [least, most] = std::minmax_element(delays.begin(), delays.end());
    EXPECT_GE(*least, config.min_tpdo_delay);
    EXPECT_LE(*most, config.max_tpdo_delay);
    EXPECT_GT(*most - *least, microseconds{800});  // 200 draws from 900 us: a smaller spread has probability < 1e-9
    if (repeat == 0) first_run = delays;
    EXPECT_EQ(delays, first_run);
  }
}

TEST_F(SynchronousPdoTest, ReportsTheVelocityBetweenTwoSyncsAcrossTheWrap) {
  start();
  configure_cyclic_torque();
  mechanism.position = 2147.483647;  // the last count before the wrap
  sync();
  run(milliseconds{1});
  mechanism.position += 25e-6;
  sync();
  EXPECT_EQ(drive->objects().get({0x6064, 0}), std::numeric_limits<std::int32_t>::min() + 24);
  EXPECT_EQ(drive->objects().get({0x606C, 0}), 25000);
}

}  // namespace
}  // namespace breakaway::drive_emulator
