// How a node is stopped, and when its stop is seen.
#include "drive_node_fixture.hpp"

namespace breakaway::odrive::test {
namespace {

class OdriveNodeStop : public NodeTest {
 protected:
  void be_forced_to_stop() {
    make_follow();
    node.request_stop();
    update_after(1ms);
    update_after(121ms);
    ASSERT_TRUE(node.stop_not_obeyed());
    heartbeat(AxisState::idle);
    update_after(1ms);
  }
};

TEST_F(OdriveNodeStop, IsToldToStopAtOnceAndEveryTwentyMilliseconds) {
  make_follow();
  node.request_stop();
  EXPECT_EQ(next(), idle);
  EXPECT_FALSE(next());
  now += 20ms - 1ns;
  EXPECT_FALSE(next());
  now += 1ns;
  EXPECT_EQ(next(), idle);
  EXPECT_FALSE(next());
}

// The stop is told again at once where it is a new one only: asking twice does not flood the bus.
TEST_F(OdriveNodeStop, IsNotToldMoreOftenWhereItsStopIsAskedForAgain) {
  make_follow();
  node.request_stop();
  EXPECT_EQ(next(), idle);
  now += 1ms;
  node.request_stop();
  EXPECT_FALSE(next());
}

// A heartbeat, and as long again as a retelling takes, or as ten periods where those are longer.
TEST_F(OdriveNodeStop, ThatStillHasForceWhenAStopMustBeSeenIsForcedByEstop) {
  struct Row {
    hal::Duration period, most;
  };
  for (const Row& row : {Row{1ms, 120ms}, Row{2ms, 120ms}, Row{5ms, 150ms}}) {
    auto settings = usual;
    settings.period = row.period;
    make_follow(settings);
    node.request_stop();
    update_after(1ms);
    EXPECT_EQ(next(), idle);
    node.on_estimate(now);
    update_after(row.most);
    EXPECT_FALSE(node.stop_not_obeyed()) << row.most.count();
    EXPECT_EQ(node.status(), SetupStatus::ready);
    EXPECT_EQ(next(), idle);
    update_after(1ns);
    EXPECT_TRUE(node.stop_not_obeyed()) << row.most.count();
    EXPECT_EQ(node.status(), SetupStatus::stop_not_obeyed);
    for (const auto& told : {idle, estop, idle, estop}) {
      now += 20ms;
      EXPECT_EQ(next(), told) << "in turn";
    }
  }
}

TEST_F(OdriveNodeStop, IsSetUpAnewAfterAStopThatWasForced) {
  be_forced_to_stop();
  EXPECT_FALSE(node.stop_not_obeyed());
  EXPECT_FALSE(node.heard());
  EXPECT_FALSE(node.take_reboot()) << "it is the same power-up";
  heartbeat(AxisState::idle);
  EXPECT_TRUE(node.heard());
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version)) << "at once";
}

// It was told to switch its power off, after all, and that is the reboot.
TEST_F(OdriveNodeStop, ThatIsSetUpAnewAfterAStopThatWasForcedMayRebootBeforeItIsReady) {
  be_forced_to_stop();
  ASSERT_FALSE(node.heard());
  update_after(250ms);
  EXPECT_TRUE(node.take_reboot());
}

// Each stop has its whole time.
TEST_F(OdriveNodeStop, CountsTheTimeOfEachStopAnew) {
  make_ready();
  for (int stop = 0; stop < 3; ++stop) {
    heartbeat(AxisState::closed_loop_control);
    update_after(1ms);
    update_after(100ms);
    EXPECT_FALSE(node.stop_not_obeyed());
    heartbeat(AxisState::idle);
    node.on_estimate(now);
    update_after(1ms);
    EXPECT_TRUE(node.ready());
  }
}

// The command may still be on its way to the drive when a heartbeat leaves it: two milliseconds, or a period.
TEST_F(OdriveNodeStop, ThatWasToldToEnableIsIdleByAHeartbeatThatIsYoungerThanTheStop) {
  struct Row {
    hal::Duration period, on_its_way;
  };
  for (const Row& row : {Row{1ms, 2ms}, Row{2ms, 2ms}, Row{5ms, 5ms}}) {
    auto settings = usual;
    settings.period = row.period;
    make_ready(settings);
    node.request_enable();
    EXPECT_EQ(next(), mode);
    EXPECT_FALSE(node.has_force());
    EXPECT_EQ(next(), enable);
    node.request_stop();
    EXPECT_TRUE(node.has_force()) << "nothing has shown what it made of it";
    heartbeat(AxisState::idle);
    node.update(now);
    EXPECT_TRUE(node.has_force()) << "no stop was told yet";
    EXPECT_EQ(next(), idle);
    now += row.on_its_way - 1ns;
    heartbeat(AxisState::idle);
    node.update(now);
    EXPECT_TRUE(node.has_force());
    now += 1ns;
    heartbeat(AxisState::idle);
    node.update(now);
    EXPECT_FALSE(node.has_force());
  }
}

// A heartbeat comes every fifth telling, so that one that fell right behind a telling would fall there for ever.
TEST_F(OdriveNodeStop, IsSeenByAHeartbeatRightBehindATellingThatWasNotTheFirst) {
  make_ready();
  node.request_enable();
  EXPECT_EQ(next(), mode);
  EXPECT_EQ(next(), enable);
  node.request_stop();
  EXPECT_EQ(next(), idle);
  now += 20ms;
  EXPECT_EQ(next(), idle);
  now += 1ms;
  heartbeat(AxisState::idle);
  node.update(now);
  EXPECT_FALSE(node.has_force());
}

// One that is asked for them reports once a period.
TEST_F(OdriveNodeStop, IsNotProvenWhileReportsOfTorqueComeHoweverLongThePeriod) {
  for (const auto period : {1ms, 10ms, 50ms}) {
    auto settings = usual;
    settings.period = period;
    make_ready(settings);
    node.on_torque(true, now);
    const hal::Duration young = std::max<hal::Duration>(20ms, 3 * period);
    update_after(young);
    EXPECT_TRUE(node.has_force()) << period.count();
    update_after(1ns);
    EXPECT_FALSE(node.has_force()) << "what it gave long ago says nothing";
  }
}

// Of a stop before, an answer says nothing of what was told since.
TEST_F(OdriveNodeStop, ThatIsEnabledAnewIsNotIdleByTheStopBefore) {
  make_follow();
  node.request_stop();
  EXPECT_EQ(next(), idle);
  now += 10ms;
  heartbeat(AxisState::idle);
  node.on_estimate(now);
  update_after(1ms);
  node.request_enable();
  EXPECT_EQ(next(), mode);
  EXPECT_EQ(next(), enable);
  heartbeat(AxisState::idle);
  update_after(1ms);
  node.request_stop();
  EXPECT_TRUE(node.has_force());
}

TEST_F(OdriveNodeStop, HasForceWhileItReportsTorqueForTwentyMilliseconds) {
  make_ready();
  node.on_torque(true, now);
  update_after(20ms);
  EXPECT_TRUE(node.has_force());
  update_after(1ns);
  EXPECT_FALSE(node.has_force());
  node.on_torque(true, now);
  update_after(1ms);
  EXPECT_TRUE(node.has_force());
  node.on_torque(false, now);
  update_after(1ms);
  EXPECT_FALSE(node.has_force());
}

// As one does that a controller left behind, and whose heartbeats somebody switched off.
TEST_F(OdriveNodeStop, ThatGivesTorqueIsToldToStopThoughNoHeartbeatOfItCame) {
  node.on_torque(false, now);
  update_after(1ms);
  EXPECT_FALSE(node.heard() || next());
  node.on_torque(true, now);
  update_after(1ms);
  EXPECT_TRUE(node.heard()) << "it takes the torque of 0, too";
  EXPECT_EQ(next(), idle);
  for (int report = 0; report < 121; ++report) {
    node.on_torque(true, now);
    update_after(1ms);
  }
  ASSERT_TRUE(node.stop_not_obeyed());
  EXPECT_EQ(next(), idle);
  now += 20ms;
  EXPECT_EQ(next(), estop);
}

}  // namespace
}  // namespace breakaway::odrive::test
