// When a node falls silent, and when it has booted anew.
#include "drive_node_fixture.hpp"

namespace breakaway::odrive::test {
namespace {

class OdriveNodeSilence : public NodeTest {};

TEST_F(OdriveNodeSilence, IsLostWhenItsHeartbeatIsOlderThanItsTimeout) {
  make_follow();
  now += 1ms;
  heartbeat(AxisState::closed_loop_control);
  node.on_estimate(now + 250ms);
  update_after(250ms);
  EXPECT_FALSE(node.heartbeat_lost());
  EXPECT_TRUE(node.follows());
  update_after(1ns);
  EXPECT_TRUE(node.heartbeat_lost());
  EXPECT_FALSE(node.wished());
  EXPECT_TRUE(node.take_reboot());
  EXPECT_FALSE(node.take_reboot()) << "told once";
  EXPECT_TRUE(node.has_force()) << "as it was seen last";
  EXPECT_EQ(next(), idle);
  update_after(1ms);
  EXPECT_FALSE(node.take_reboot()) << "of one silence, one";
  heartbeat(AxisState::idle);
  EXPECT_FALSE(node.heartbeat_lost());
}

TEST_F(OdriveNodeSilence, WithoutForceThatFallsSilentIsSetUpAnew) {
  make_ready();
  heartbeat(AxisState::idle);
  node.on_estimate(now + 250ms);
  update_after(250ms + 1ns);
  EXPECT_TRUE(node.heartbeat_lost());
  EXPECT_TRUE(node.take_reboot());
  EXPECT_FALSE(node.heard());
  EXPECT_EQ(node.status(), SetupStatus::no_heartbeat);
}

TEST_F(OdriveNodeSilence, IsStoppedWhenItsEstimatesAreOlderThanTheTimeout) {
  make_follow();
  node.on_estimate(now);
  now += 250ms;
  heartbeat(AxisState::closed_loop_control);
  node.update(now);
  EXPECT_TRUE(node.follows());
  update_after(1ns);
  EXPECT_FALSE(node.wished());
  EXPECT_FALSE(node.heartbeat_lost()) << "its heartbeats come";
  EXPECT_TRUE(node.take_reboot());
  EXPECT_EQ(next(), idle);
}

// A reboot takes no longer because somebody is patient with its heartbeats.
TEST_F(OdriveNodeSilence, MayHaveRebootedWhenItsEstimatesWereAwayForAsLongAsABootTakes) {
  auto patient = usual;
  patient.heartbeat_timeout = 2s;
  make_follow(patient);
  node.on_estimate(now);
  update_after(250ms);
  EXPECT_TRUE(node.follows());
  update_after(1ns);
  EXPECT_FALSE(node.heartbeat_lost() || node.wished());
  EXPECT_TRUE(node.take_reboot());
  patient.period = 50ms;
  make_ready(patient);
  node.on_estimate(now);
  update_after(500ms);
  EXPECT_FALSE(node.take_reboot()) << "ten periods";
  update_after(1ns);
  EXPECT_TRUE(node.take_reboot());
  EXPECT_FALSE(node.heard()) << "it is set up anew";
}

TEST_F(OdriveNodeSilence, ThatIsSetUpAnewMayRebootAlthoughItsHeartbeatsMayBeAwayForLonger) {
  auto patient = usual;
  patient.heartbeat_timeout = 2s;
  make_ready(patient);
  heartbeat(AxisState::undefined);
  ASSERT_TRUE(node.take_reboot());
  heartbeat(AxisState::idle);
  node.on_estimate(now);
  node.note_reference();
  update_after(250ms);
  EXPECT_FALSE(node.take_reboot());
  update_after(1ns);
  EXPECT_TRUE(node.take_reboot());
}

TEST_F(OdriveNodeSilence, ThatIsSetUpIsNotBlindBeforeItIsReady) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version));
  for (int i = 0; i < 5; ++i) {
    now += 100ms;
    heartbeat(AxisState::idle);
    node.update(now);
    EXPECT_EQ(node.status(), SetupStatus::no_version);
  }
  EXPECT_FALSE(node.take_reboot()) << "it was never known";
}

TEST_F(OdriveNodeSilence, ThatIsRefusedStaysSoInSilence) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  version(0, 5);
  update_after(1s);
  EXPECT_TRUE(node.refused());
  EXPECT_FALSE(node.heartbeat_lost() || node.take_reboot());
}

TEST_F(OdriveNodeSilence, ThatStartsAgainHasRebootedOnce) {
  for (const AxisState state : {AxisState::undefined, AxisState::startup_sequence}) {
    make_ready();
    EXPECT_FALSE(node.take_reboot());
    heartbeat(state);
    EXPECT_TRUE(node.take_reboot());
    EXPECT_FALSE(node.heard());
    heartbeat(state);
    EXPECT_FALSE(node.take_reboot());
    heartbeat(AxisState::idle);
    heartbeat(state);
    EXPECT_FALSE(node.take_reboot()) << "it was not set up in between";
  }
}

TEST_F(OdriveNodeSilence, ThatRebootsInSilenceOnTheWayIsToldAllAgain) {
  make_ready();
  heartbeat(AxisState::undefined);
  update_after(1ms);
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version)) << "at once";
  version(0, 6);
  EXPECT_EQ(next(), mode);
  update_after(1ms);
  EXPECT_FALSE(node.ready()) << "no estimate of this power-up";
  node.on_estimate(now);
  update_after(1ms);
  EXPECT_TRUE(node.ready());
}

// Where the axis stands may be said as soon as a sample came, long before the set-up is over.
TEST_F(OdriveNodeSilence, ThatWasToldWhereItStandsRebootsThoughItIsStillSetUp) {
  const auto is_told_on_the_way = [&] {
    make_ready();
    heartbeat(AxisState::undefined);
    ASSERT_TRUE(node.take_reboot());
    heartbeat(AxisState::idle);
    update_after(1ms);
    node.note_reference();
    EXPECT_FALSE(node.ready() || node.take_reboot());
  };
  is_told_on_the_way();
  heartbeat(AxisState::startup_sequence);
  EXPECT_TRUE(node.take_reboot()) << "it says so";
  is_told_on_the_way();
  update_after(251ms);
  EXPECT_TRUE(node.take_reboot()) << "unheard";
  update_after(1ms);
  EXPECT_FALSE(node.take_reboot()) << "of one silence, one";
}

TEST_F(OdriveNodeSilence, ThatWasToldWhereItStandsBeforeItsFirstHeartbeatRebootsWhenItsEstimatesEnd) {
  node.on_estimate(now);
  node.note_reference();
  update_after(250ms);
  EXPECT_FALSE(node.take_reboot()) << "it sends no heartbeat yet";
  update_after(1ns);
  EXPECT_TRUE(node.take_reboot());
}

}  // namespace
}  // namespace breakaway::odrive::test
