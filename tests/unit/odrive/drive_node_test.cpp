// When a node is set up, told to enable and asked: ties and defaults.
#include "drive_node_fixture.hpp"

namespace breakaway::odrive::test {
namespace {

class OdriveNode : public NodeTest {};

TEST_F(OdriveNode, IsNothingBeforeItIsHeard) {
  EXPECT_FALSE(next());
  update_after(1ms);
  EXPECT_FALSE(next());
  EXPECT_FALSE(node.heard() || node.ready() || node.refused() || node.wished() || node.follows() || node.has_force());
  EXPECT_FALSE(node.stop_not_obeyed() || node.heartbeat_lost() || node.take_reboot());
  EXPECT_EQ(node.code(), 0);
  EXPECT_EQ(node.take_new_code(), 0);
  EXPECT_EQ(node.errors(), 0U);
  EXPECT_EQ(node.axis_state(), AxisState::undefined);
  EXPECT_EQ(node.status(), SetupStatus::no_heartbeat);
}

// A caller may ask it before the first period, too.
TEST_F(OdriveNode, HasNoForceAndNoFaultBeforeItsFirstPeriod) {
  EXPECT_FALSE(node.has_force() || node.stop_not_obeyed());
  EXPECT_EQ(node.code(), 0);
  EXPECT_EQ(node.errors(), 0U);
}

TEST_F(OdriveNode, OfSettingsThatNameNothingHasNoLimits) {
  const NodeSettings untold;
  EXPECT_EQ(untold.node_id, 1);
  EXPECT_FALSE(untold.polled);
  EXPECT_EQ(untold.velocity_limit_turns_s, 0);
  EXPECT_EQ(untold.current_limit_A, 0);
}

TEST_F(OdriveNode, IsAskedForItsVersionEveryTenthOfASecond) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  const auto question = request_frame(asked_node, Command::get_version);
  EXPECT_EQ(next(), question);
  EXPECT_FALSE(next());
  now += 100ms - 1ns;
  EXPECT_FALSE(next());
  now += 1ns;
  EXPECT_EQ(next(), question);
  EXPECT_FALSE(next());
}

TEST_F(OdriveNode, IsUsedFromVersion06On) {
  struct Row {
    std::uint8_t major, minor;
    bool used;
  };
  for (const Row& row : {Row{0, 5, false}, Row{0, 6, true}, Row{0, 7, true}, Row{1, 0, true}, Row{2, 9, true}}) {
    node = DriveNode{usual};
    heartbeat(AxisState::idle);
    update_after(1ms);
    version(row.major, row.minor);
    EXPECT_EQ(node.refused(), !row.used) << int{row.major} << "." << int{row.minor};
    EXPECT_EQ(node.status(), row.used ? SetupStatus::being_told : SetupStatus::firmware_too_old);
  }
}

TEST_F(OdriveNode, IsToldItsModeAndItsLimitsOnceAndThenListenedFor) {
  auto limited = usual;
  limited.velocity_limit_turns_s = 30;
  limited.current_limit_A = 0.5F;
  node = DriveNode{limited};
  heartbeat(AxisState::idle);
  update_after(1ms);
  version(0, 6);
  EXPECT_EQ(node.status(), SetupStatus::being_told);
  EXPECT_EQ(next(), mode);
  EXPECT_EQ(node.status(), SetupStatus::being_told);
  EXPECT_EQ(next(), limits_frame(asked_node, 30, 0.5F));
  EXPECT_EQ(node.status(), SetupStatus::no_estimates);
  EXPECT_FALSE(next());
  node.on_estimate(now);
  heartbeat(AxisState::idle);
  update_after(250ms);
  EXPECT_TRUE(node.ready()) << "an estimate may be as old as a heartbeat";
  EXPECT_EQ(node.status(), SetupStatus::ready);
}

TEST_F(OdriveNode, IsNotReadyByAnEstimateThatIsTooOld) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  version(0, 6);
  EXPECT_EQ(next(), mode);
  node.on_estimate(now);
  heartbeat(AxisState::idle);
  now += 250ms;
  heartbeat(AxisState::idle);
  update_after(1ns);
  EXPECT_FALSE(node.ready());
}

TEST_F(OdriveNode, IsToldTheModeAndThenToEnableUntilItShowsThatItDid) {
  make_ready();
  node.request_enable();
  EXPECT_EQ(next(), mode);
  EXPECT_EQ(next(), enable);
  EXPECT_EQ(next(), ask_heartbeat);
  EXPECT_FALSE(next());
  now += 10ms - 1ns;
  EXPECT_FALSE(next());
  now += 1ns;
  EXPECT_EQ(next(), ask_heartbeat) << "every 10 ms";
  heartbeat(AxisState::closed_loop_control);
  EXPECT_FALSE(node.follows()) << "a period sees it";
  update_after(100ms);
  EXPECT_TRUE(node.follows());
  EXPECT_TRUE(node.has_force());
  EXPECT_FALSE(next());
}

TEST_F(OdriveNode, IsToldAgainToEnableWhenTwoHeartbeatsCouldHaveShownIt) {
  struct Row {
    hal::Duration heartbeat_period, interval;
  };
  for (const Row& row : {Row{100ms, 200ms}, Row{60ms, 120ms}, Row{50ms, 100ms}, Row{20ms, 100ms}}) {
    auto settings = usual;
    settings.heartbeat_period = row.heartbeat_period;
    make_ready(settings);
    node.request_enable();
    EXPECT_EQ(next(), mode);
    EXPECT_EQ(next(), enable);
    now += row.interval - 1ns;
    EXPECT_EQ(next(), ask_heartbeat);
    EXPECT_FALSE(next());
    now += 1ns;
    EXPECT_EQ(next(), mode);
    EXPECT_EQ(next(), enable);
    node.request_stop();
  }
}

TEST_F(OdriveNode, ThatSaysWhyItDoesNotEnableIsToldSoThreeTimes) {
  for (const std::uint8_t result : {std::uint8_t{3}, std::uint8_t{14}}) {
    make_ready();
    node.request_enable();
    int told = 0;
    for (int i = 0; i < 2000 && node.wished(); ++i) {
      heartbeat(AxisState::idle, 0, result);
      node.on_estimate(now);
      if (const auto frame = next()) told += *frame == enable;  // one a period, as the loop does
      update_after(1ms);
    }
    EXPECT_EQ(told, 3);
    EXPECT_FALSE(node.wished());
    EXPECT_EQ(node.code(), procedure_code(result));
    EXPECT_EQ(node.take_new_code(), procedure_code(result));
    EXPECT_EQ(node.take_new_code(), 0) << "told once";
  }
}

TEST_F(OdriveNode, IsToldForEverWhereTheResultIsNoFailure) {
  for (const std::uint8_t result : {procedure_succeeded, procedure_busy, procedure_cancelled}) {
    make_ready();
    node.request_enable();
    int told = 0;
    for (int i = 0; i < 2000; ++i) {
      heartbeat(AxisState::idle, 0, result);
      node.on_estimate(now);
      if (const auto frame = next()) told += *frame == enable;  // one a period, as the loop does
      update_after(1ms);
    }
    EXPECT_EQ(told, 10) << int{result};
    EXPECT_TRUE(node.wished());
  }
}

// The attempts of an earlier wish do not count.
TEST_F(OdriveNode, CountsTheAttemptsOfEachWishAnew) {
  make_ready();
  for (int wish = 0; wish < 5; ++wish) {
    node.request_enable();
    EXPECT_EQ(next(), mode);
    EXPECT_EQ(next(), enable);
    heartbeat(AxisState::idle, 0, 14);
    node.on_estimate(now);
    update_after(1ms);
    EXPECT_TRUE(node.wished());
    node.request_stop();
    EXPECT_EQ(next(), idle);
    now += 2ms;
    heartbeat(AxisState::idle, 0, 14);
    update_after(1ms);
    EXPECT_FALSE(node.has_force());
    EXPECT_EQ(node.code(), 0);
  }
}

TEST_F(OdriveNode, IsNotEnabledBeforeItIsReadyOrWhileItHasForceOrAFault) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  node.request_enable();
  EXPECT_FALSE(node.wished()) << "not set up";
  make_ready();
  heartbeat(AxisState::closed_loop_control);
  update_after(1ms);
  node.request_enable();
  EXPECT_FALSE(node.wished()) << "somebody else's force";
  make_ready();
  heartbeat(AxisState::idle, error::initializing << 1U);
  update_after(1ms);
  node.request_enable();
  EXPECT_FALSE(node.wished()) << "an error";
}

TEST_F(OdriveNode, MayStartForThreeSeconds) {
  heartbeat(AxisState::idle, error::initializing | error::missing_input);
  EXPECT_EQ(node.errors(), error::missing_input) << "no error yet";
  EXPECT_EQ(node.status(), SetupStatus::starting);
  now += 3s;
  heartbeat(AxisState::idle, error::initializing);
  EXPECT_EQ(node.errors(), 0U);
  EXPECT_EQ(node.status(), SetupStatus::starting);
  now += 1ns;
  heartbeat(AxisState::idle, error::initializing);
  EXPECT_EQ(node.errors(), error::initializing);
  EXPECT_TRUE(node.heard());
}

TEST_F(OdriveNode, HasThreeSecondsForEachStart) {
  heartbeat(AxisState::idle, error::initializing);
  now += 2s;
  heartbeat(AxisState::idle);
  now += 2s;
  heartbeat(AxisState::idle, error::initializing);
  EXPECT_EQ(node.errors(), 0U);
  now += 3s;
  heartbeat(AxisState::idle, error::initializing);
  EXPECT_EQ(node.errors(), 0U);
}

TEST_F(OdriveNode, IsWaitedForWhileItsStateIsOneOfAStart) {
  for (const AxisState state : {AxisState::undefined, AxisState::startup_sequence}) {
    node = DriveNode{usual};
    heartbeat(state);
    EXPECT_FALSE(node.heard());
    EXPECT_FALSE(node.take_reboot()) << "nothing is known of it that a start could have changed";
    EXPECT_EQ(node.status(), SetupStatus::starting);
    heartbeat(AxisState::idle);
    EXPECT_TRUE(node.heard());
  }
}

// A version that nobody waits for, as of an answer that came twice, changes nothing.
TEST_F(OdriveNode, TakesAVersionOnlyWhereItAskedForIt) {
  make_ready();
  version(0, 5);
  EXPECT_TRUE(node.ready());
  version(0, 6);
  EXPECT_TRUE(node.ready());
  EXPECT_FALSE(next());
}

TEST_F(OdriveNode, ThatIsPolledIsAskedForItsHeartbeatEveryTenMilliseconds) {
  auto polled = usual;
  polled.polled = true;
  make_ready(polled);
  EXPECT_EQ(next(), ask_heartbeat);
  EXPECT_FALSE(next());
  now += 10ms - 1ns;
  EXPECT_FALSE(next());
  now += 1ns;
  EXPECT_EQ(next(), ask_heartbeat);
  node.on_torque(true, now);
  update_after(10ms);
  EXPECT_EQ(next(), idle);
  EXPECT_EQ(next(), ask_heartbeat) << "while it is stopped, too";
  EXPECT_FALSE(next());
}

}  // namespace
}  // namespace breakaway::odrive::test
