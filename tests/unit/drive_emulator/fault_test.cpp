#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

using cia402::State;

class DriveFaultTest : public DriveBench {
 protected:
  void watch_master_heartbeat() { expect_written({0x23, 0x16, 0x10, 1, 50, 0, 0x7F, 0}); }  // node 127, 50 ms
  void master_heartbeat() { send(0x77F, {0x05}); }
};

TEST_F(DriveFaultTest, WalksTheProfilesStatesWithTheirStatuswords) {
  start();
  set_torque_mode();
  EXPECT_EQ(statusword(), 0x0250U);
  controlword(0x06);
  EXPECT_EQ(statusword(), 0x0231U);
  controlword(0x07);
  EXPECT_EQ(statusword(), 0x0233U);
  controlword(0x0F);
  EXPECT_EQ(statusword(), 0x1237U);
  controlword(0x10F);
  EXPECT_EQ(statusword(), 0x0237U) << "halted";
  controlword(0x0F);
  send(0x605, {0x2B, 0x40, 0x60, 0, 0x02, 0, 0, 0});
  EXPECT_EQ(drive->objects().get({0x6041, 0}), 0x0217) << "quick stop active";
  run(milliseconds{1});
  EXPECT_EQ(statusword(), 0x0250U);
}

TEST_F(DriveFaultTest, AFaultRemovesTheTorqueAndIsTold) {
  start();
  enable_cyclic();
  cycle(0x0F, 800);
  sync();
  EXPECT_DOUBLE_EQ(force_N(), 8.0);
  drive->trip_fault(0x2310, now);
  EXPECT_EQ(force_N(), 0);
  EXPECT_EQ(last(0x085), (Bytes{0x10, 0x23, 0x03, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive->objects().get({0x6041, 0}), 0x021F) << "fault reaction active";
  run(milliseconds{1});
  EXPECT_EQ(drive->objects().get({0x6041, 0}), 0x0218) << "fault";
  EXPECT_EQ(drive->objects().get({0x603F, 0}), 0x2310);
  EXPECT_EQ(drive->objects().get({0x1001, 0}), 0x03);
}

TEST_F(DriveFaultTest, StaysInFaultUntilTheRisingEdgeOfReset) {
  start();
  enable_cyclic();
  drive->trip_fault(0x7305, now);
  for (const unsigned word : {0x0FU, 0x06U, 0x00U, 0x0FU}) {
    cycle(word, 500);
    EXPECT_EQ(drive->state(), State::fault);
    EXPECT_EQ(force_N(), 0);
  }
  sent.clear();
  cycle(0x80, 0);
  sync();
  EXPECT_EQ(drive->state(), State::switch_on_disabled);
  EXPECT_EQ(last(0x085), (Bytes{0, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(drive->objects().get({0x603F, 0}), 0);
  drive->trip_fault(0x7305, now);
  run(milliseconds{2});
  cycle(0x80, 0);
  cycle(0x80, 0);
  EXPECT_EQ(drive->state(), State::fault) << "bit 7 was never low in between";
}

TEST_F(DriveFaultTest, KeepsAHistoryNewestFirst) {
  start();
  for (const std::uint16_t code : {std::uint16_t{0x2310}, std::uint16_t{0x3210}}) drive->trip_fault(code, now);
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 0, 0, 0, 0, 0}).at(4), 2U);
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 1, 0, 0, 0, 0}), (Bytes{0x43, 0x03, 0x10, 1, 0x10, 0x32, 0, 0}));
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 2, 0, 0, 0, 0}), (Bytes{0x43, 0x03, 0x10, 2, 0x10, 0x23, 0, 0}));
  expect_written({0x2F, 0x03, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(sdo({0x40, 0x03, 0x10, 1, 0, 0, 0, 0}), (Bytes{0x43, 0x03, 0x10, 1, 0, 0, 0, 0}));
}

TEST_F(DriveFaultTest, TellsAnErrorOnceHoweverLongItLasts) {
  start();
  enable_cyclic();
  for (int i = 0; i < 5; ++i) send(0x205, {0x0F});
  EXPECT_EQ(count(0x085), 1U);
}

TEST_F(DriveFaultTest, EmcyCanBeMovedAndSwitchedOff) {
  start();
  expect_written({0x23, 0x14, 0x10, 0, 0x95, 0, 0, 0});
  drive->trip_fault(0x2310, now);
  EXPECT_EQ(count(0x095), 1U);
  expect_written({0x23, 0x14, 0x10, 0, 0x95, 0, 0, 0x80});
  sent.clear();
  drive->trip_fault(0x3210, now);
  EXPECT_TRUE(sent.empty());
}

TEST_F(DriveFaultTest, LosingTheMastersHeartbeatStopsTheDrive) {
  start();
  watch_master_heartbeat();
  run(milliseconds{500});
  EXPECT_EQ(drive->state(), State::switch_on_disabled) << "watched from the first heartbeat on only";
  master_heartbeat();
  enable();
  master_heartbeat();
  target_torque(500);
  run(milliseconds{48});
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  sent.clear();
  run(milliseconds{1});
  EXPECT_EQ(force_N(), 0);
  EXPECT_EQ(drive->state(), State::fault_reaction_active);
  EXPECT_EQ(last(0x085), (Bytes{0x30, 0x81, 0x11, 0, 0, 0, 0, 0}));
  run(milliseconds{1});
  controlword(0x00);
  controlword(0x80);
  EXPECT_EQ(drive->state(), State::fault) << "no reset while the master is away";
  master_heartbeat();
  controlword(0x00);
  controlword(0x80);
  EXPECT_EQ(drive->state(), State::switch_on_disabled);
}

TEST_F(DriveFaultTest, ErrorBehaviourChoosesTheNmtStateAfterHeartbeatLoss) {
  using canopen::NmtState;
  const NmtState expected[] = {NmtState::pre_operational, NmtState::operational, NmtState::stopped};
  for (unsigned behaviour = 0; behaviour < 3; ++behaviour) {
    now = hal::Time{};
    mechanism = {};
    start();
    watch_master_heartbeat();
    expect_written({0x2F, 0x29, 0x10, 1, behaviour, 0, 0, 0});
    enable_cyclic();
    master_heartbeat();
    for (int i = 0; i < 60; ++i) cycle(0x0F, 100);
    EXPECT_EQ(drive->nmt_state(), expected[behaviour]);
    EXPECT_EQ(drive->state(), State::fault);
    EXPECT_EQ(force_N(), 0);
  }
}

TEST_F(DriveFaultTest, AnRpdoThatMissesItsDeadlineStopsTheDrive) {
  start();
  enable_cyclic();
  expect_written({0x2B, 0x00, 0x14, 5, 3, 0, 0, 0});
  for (int i = 0; i < 5; ++i) cycle(0x0F, 500);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  run(milliseconds{2});
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  run(milliseconds{1});
  EXPECT_EQ(force_N(), 0);
  EXPECT_EQ(last(0x085), (Bytes{0x50, 0x82, 0x11, 0, 0, 0, 0, 0}));
}

TEST_F(DriveFaultTest, QuickStopRemovesTheTorqueAndHonoursItsOptionCode) {
  start();
  expect_written({0x2B, 0x5A, 0x60, 0, 6, 0, 0, 0});
  enable();
  target_torque(500);
  controlword(0x02);
  EXPECT_EQ(force_N(), 0);
  run(milliseconds{100});
  EXPECT_EQ(statusword(), 0x0217U);
  controlword(0x0F);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
}

TEST_F(DriveFaultTest, MakesTorqueInOperationEnabledAndTorqueModeOnly) {
  start();
  target_torque(500);
  EXPECT_EQ(force_N(), 0);
  set_torque_mode();
  for (const unsigned word : {0x06U, 0x07U}) {
    controlword(word);
    EXPECT_EQ(force_N(), 0);
  }
  controlword(0x0F);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  expect_written({0x2F, 0x60, 0x60, 0, 0, 0, 0, 0});
  EXPECT_EQ(force_N(), 0);
  set_torque_mode();
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  controlword(0x10F);
  EXPECT_EQ(force_N(), 0) << "halt";
  controlword(0x07);
  EXPECT_EQ(force_N(), 0);
}

}  // namespace
}  // namespace breakaway::drive_emulator
