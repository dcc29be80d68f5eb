#include "drive_bench.hpp"

namespace breakaway::drive_emulator {
namespace {

using canopen::NmtState;

class DriveNetworkTest : public DriveBench {};

TEST_F(DriveNetworkTest, AnnouncesItselfAfterBooting) {
  start();
  drive->power_off(now);
  drive->power_on(now);
  run(microseconds{4999});
  EXPECT_TRUE(sent.empty());
  run(microseconds{1});
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].frame.id, 0x705);
  EXPECT_EQ(bytes_of(sent[0].frame), (Bytes{0x00}));
  EXPECT_EQ(drive->nmt_state(), NmtState::pre_operational);
  EXPECT_EQ(drive->state(), cia402::State::switch_on_disabled);
}

TEST_F(DriveNetworkTest, ObeysNmtCommandsForItselfAndForAll) {
  start();
  struct Row {
    unsigned command, node;
    NmtState expected;
  };
  const Row rows[] = {{0x01, 5, NmtState::operational},     {0x80, 5, NmtState::pre_operational},
                      {0x02, 5, NmtState::stopped},         {0x01, 0, NmtState::operational},
                      {0x02, 0, NmtState::stopped},         {0x80, 0, NmtState::pre_operational},
                      {0x01, 6, NmtState::pre_operational}, {0x33, 5, NmtState::pre_operational}};
  for (const Row& row : rows) {
    send(0x000, {row.command, row.node});
    EXPECT_EQ(drive->nmt_state(), row.expected) << row.command << " to " << row.node;
  }
}

TEST_F(DriveNetworkTest, IgnoresNmtFramesOfWrongLength) {
  start();
  send(0x000, {0x01});
  EXPECT_EQ(drive->nmt_state(), NmtState::pre_operational);
}

TEST_F(DriveNetworkTest, ResetNodeRestoresEveryParameterAndAnnouncesItself) {
  start();
  expect_written({0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  target_torque(77);
  enable();
  sent.clear();
  send(0x000, {0x81, 5});
  EXPECT_EQ(force_N(), 0);
  run(milliseconds{50});
  EXPECT_EQ(last(0x705), (Bytes{0x00}));
  EXPECT_EQ(count(0x705), 1U);
  EXPECT_EQ(drive->objects().get({0x1017, 0}), 0);
  EXPECT_EQ(drive->objects().get({0x6071, 0}), 0);
  EXPECT_EQ(drive->state(), cia402::State::switch_on_disabled);
}

TEST_F(DriveNetworkTest, ResetForgetsAnSdoTransferAndFramesNotYetSent) {
  start();
  sdo({0x40, 0x08, 0x10, 0, 0, 0, 0, 0});
  send(0x605, {0x60, 0, 0, 0, 0, 0, 0, 0});
  send(0x000, {0x82, 5});
  run(milliseconds{6});
  EXPECT_EQ(count(0x585), 0U);
  EXPECT_EQ(abort_code({0x70, 0, 0, 0, 0, 0, 0, 0}), 0x05040001U);
}

TEST_F(DriveNetworkTest, ResetCommunicationKeepsTheDriveParameters) {
  start();
  expect_written({0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  target_torque(77);
  send(0x000, {0x82, 5});
  run(milliseconds{6});
  EXPECT_EQ(last(0x705), (Bytes{0x00}));
  EXPECT_EQ(drive->objects().get({0x1017, 0}), 0);
  EXPECT_EQ(drive->objects().get({0x6071, 0}), 77);
}

TEST_F(DriveNetworkTest, IsDeafWhileItBoots) {
  start();
  send(0x000, {0x81, 5});
  send(0x000, {0x01, 5});
  run(milliseconds{10});
  EXPECT_EQ(drive->nmt_state(), NmtState::pre_operational);
}

TEST_F(DriveNetworkTest, AnswersNoSdoWhenStopped) {
  start();
  send(0x000, {0x02, 5});
  EXPECT_TRUE(sdo({0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).empty());
}

TEST_F(DriveNetworkTest, ProducesItsHeartbeatInEveryState) {
  start();
  expect_written({0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  run(milliseconds{100});
  EXPECT_EQ(last(0x705), (Bytes{0x7F}));
  send(0x000, {0x01, 5});
  run(milliseconds{100});
  EXPECT_EQ(last(0x705), (Bytes{0x05}));
  send(0x000, {0x02, 5});
  run(milliseconds{100});
  EXPECT_EQ(last(0x705), (Bytes{0x04}));
  sent.clear();
  run(milliseconds{1000});
  EXPECT_EQ(count(0x705), 10U);
  drive->suppress_heartbeat(true);
  sent.clear();
  run(milliseconds{1000});
  EXPECT_EQ(count(0x705), 0U);
}

TEST_F(DriveNetworkTest, ProcessDataFlowsInOperationalOnly) {
  start();
  configure_cyclic_torque();
  for (const unsigned command : {0x80U, 0x02U}) {
    send(0x000, {command, 5});
    sent.clear();
    for (int i = 0; i < 3; ++i) cycle(0x06, 0);
    EXPECT_EQ(count(0x185), 0U);
    EXPECT_EQ(drive->state(), cia402::State::switch_on_disabled);
  }
  send(0x000, {0x01, 5});
  for (int i = 0; i < 3; ++i) cycle(0x06, 0);
  EXPECT_EQ(count(0x185), 3U);
  EXPECT_EQ(drive->state(), cia402::State::ready_to_switch_on);
}

TEST_F(DriveNetworkTest, LeavingOperationalRemovesTheTorque) {
  start();
  enable_cyclic();
  cycle(0x0F, 500);
  cycle(0x0F, 500);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  send(0x000, {0x80, 5});
  EXPECT_EQ(force_N(), 0);
  EXPECT_EQ(drive->state(), cia402::State::switch_on_disabled);
}

TEST_F(DriveNetworkTest, UnpluggedItNeitherHearsNorSpeaks) {
  start();
  expect_written({0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  drive->set_silent(true);
  send(0x000, {0x01, 5});
  run(milliseconds{500});
  EXPECT_TRUE(sent.empty());
  EXPECT_EQ(drive->nmt_state(), NmtState::pre_operational);
  drive->set_silent(false);
  run(milliseconds{100});
  EXPECT_EQ(last(0x705), (Bytes{0x7F}));
}

TEST_F(DriveNetworkTest, PoweredOffItLosesTorqueAndMemory) {
  start();
  enable();
  target_torque(500);
  EXPECT_DOUBLE_EQ(force_N(), 5.0);
  drive->power_off(now);
  EXPECT_EQ(force_N(), 0);
  EXPECT_FALSE(drive->next_event());
  EXPECT_TRUE(sdo({0x40, 0x00, 0x10, 0, 0, 0, 0, 0}).empty());
  drive->power_on(now);
  run(milliseconds{5});
  EXPECT_EQ(drive->objects().get({0x6071, 0}), 0);
  EXPECT_EQ(drive->state(), cia402::State::switch_on_disabled);
}

TEST_F(DriveNetworkTest, IgnoresRemoteFramesAndOtherNodes) {
  start();
  drive->on_frame({.id = 0x605, .size = 8, .remote = true, .data = {0x40, 0x00, 0x10}}, now);
  send(0x606, {0x40, 0x00, 0x10, 0, 0, 0, 0, 0});
  run(milliseconds{10});
  EXPECT_TRUE(sent.empty());
}

TEST_F(DriveNetworkTest, TellsWhenItIsDueNext) {
  start();
  EXPECT_FALSE(drive->next_event());
  expect_written({0x2B, 0x17, 0x10, 0, 100, 0, 0, 0});
  const hal::Time written = now - milliseconds{1};
  EXPECT_EQ(drive->next_event(), written + milliseconds{100});
}

}  // namespace
}  // namespace breakaway::drive_emulator
