// When a node is stopped, lost, in fault and reset: ties, and what is told once.
#include "drive_node_fixture.hpp"

namespace breakaway::odrive::test {
namespace {

class OdriveNodeStop : public NodeTest {};

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
  make_follow();
  node.request_stop();
  update_after(1ms);
  update_after(121ms);
  ASSERT_TRUE(node.stop_not_obeyed());
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_FALSE(node.stop_not_obeyed());
  EXPECT_FALSE(node.heard());
  EXPECT_FALSE(node.take_reboot()) << "it is the same power-up";
  heartbeat(AxisState::idle);
  EXPECT_TRUE(node.heard());
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version)) << "at once";
}

// It was told to switch its power off, after all, and that is the reboot.
TEST_F(OdriveNodeStop, ThatIsSetUpAnewAfterAStopThatWasForcedMayRebootBeforeItIsReady) {
  make_follow();
  node.request_stop();
  update_after(1ms);
  update_after(121ms);
  ASSERT_TRUE(node.stop_not_obeyed());
  heartbeat(AxisState::idle);
  update_after(1ms);
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

TEST_F(OdriveNodeStop, IsLostWhenItsHeartbeatIsOlderThanItsTimeout) {
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

TEST_F(OdriveNodeStop, WithoutForceThatFallsSilentIsSetUpAnew) {
  make_ready();
  heartbeat(AxisState::idle);
  node.on_estimate(now + 250ms);
  update_after(250ms + 1ns);
  EXPECT_TRUE(node.heartbeat_lost());
  EXPECT_TRUE(node.take_reboot());
  EXPECT_FALSE(node.heard());
  EXPECT_EQ(node.status(), SetupStatus::no_heartbeat);
}

TEST_F(OdriveNodeStop, IsStoppedWhenItsEstimatesAreOlderThanTheTimeout) {
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
TEST_F(OdriveNodeStop, MayHaveRebootedWhenItsEstimatesWereAwayForAsLongAsABootTakes) {
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

TEST_F(OdriveNodeStop, ThatIsSetUpAnewMayRebootAlthoughItsHeartbeatsMayBeAwayForLonger) {
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

TEST_F(OdriveNodeStop, ThatIsSetUpIsNotBlindBeforeItIsReady) {
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

TEST_F(OdriveNodeStop, ThatIsRefusedStaysSoInSilence) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  version(0, 5);
  update_after(1s);
  EXPECT_TRUE(node.refused());
  EXPECT_FALSE(node.heartbeat_lost() || node.take_reboot());
}

TEST_F(OdriveNodeStop, ThatLeftByItselfIsAskedWhyForFivePeriodsAndThenStopped) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  for (int period = 0; period < 5; ++period) {
    EXPECT_TRUE(node.wished()) << period;
    EXPECT_EQ(next(), ask_errors) << period;
    EXPECT_EQ(next(), ask_errors) << "as often as there is room";
    update_after(1ms);
  }
  EXPECT_FALSE(node.wished());
  EXPECT_FALSE(next());
  EXPECT_EQ(node.code(), 0);
}

TEST_F(OdriveNodeStop, TakesTheReasonOfADisarmingWhileItAsksOnly) {
  make_follow();
  errors(0, error::estop_requested);
  EXPECT_EQ(node.code(), 0) << "it may be from before";
  heartbeat(AxisState::idle);
  update_after(1ms);
  errors(error::initializing, error::initializing);
  EXPECT_EQ(node.code(), 0) << "no reason";
  EXPECT_TRUE(node.wished());
  errors(0, error::estop_requested);
  EXPECT_EQ(node.code(), error_code(error::estop_requested));
  EXPECT_FALSE(node.wished());
  EXPECT_FALSE(next()) << "it is asked no more";
  errors(0, error::missing_input);
  EXPECT_EQ(node.code(), error_code(error::estop_requested)) << "the first is kept";
}

TEST_F(OdriveNodeStop, TakesAnActiveErrorForAReasonToo) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  errors(error::missing_input, 0);
  EXPECT_EQ(node.code(), error_code(error::missing_input));
}

TEST_F(OdriveNodeStop, ThatIsBackInClosedLoopControlIsAskedNoMore) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_EQ(next(), ask_errors);
  heartbeat(AxisState::closed_loop_control);
  update_after(1ms);
  EXPECT_FALSE(next());
  EXPECT_TRUE(node.follows());
  heartbeat(AxisState::idle);
  update_after(1ms);
  for (int period = 0; period < 5; ++period, update_after(1ms)) EXPECT_TRUE(node.wished()) << period;
  EXPECT_FALSE(node.wished());
}

TEST_F(OdriveNodeStop, NamesTheFirstFaultOfItsOwnAndTellsItOnce) {
  make_follow();
  node.fail(OwnFault::position_too_coarse);
  node.fail(OwnFault::torque_not_a_number);
  EXPECT_FALSE(node.wished());
  EXPECT_EQ(node.code(), static_cast<std::uint16_t>(OwnFault::position_too_coarse));
  EXPECT_EQ(node.take_new_code(), static_cast<std::uint16_t>(OwnFault::position_too_coarse));
  node.fail(OwnFault::position_too_coarse);
  EXPECT_EQ(node.take_new_code(), 0) << "it is still the same";
  EXPECT_EQ(next(), idle) << "at once";
}

TEST_F(OdriveNodeStop, IsToldToClearOnceAndItsModeAnewWhenItIsReset) {
  make_ready();
  node.fail(OwnFault::position_too_coarse);
  node.reset_fault();
  EXPECT_NE(node.code(), 0) << "a period takes it up";
  update_after(1ms);
  EXPECT_EQ(node.code(), 0);
  EXPECT_EQ(node.take_new_code(), 0) << "it was reset before it was told";
  EXPECT_EQ(next(), clear_errors_frame(asked_node));
  EXPECT_EQ(next(), mode);
  EXPECT_FALSE(next());
  node.on_estimate(now);
  update_after(1ms);
  EXPECT_TRUE(node.ready());
  EXPECT_FALSE(next());
}

TEST_F(OdriveNodeStop, ThatIsLostIsNotAnyMoreWhenItIsReset) {
  make_ready();
  update_after(251ms);
  ASSERT_TRUE(node.heartbeat_lost());
  node.reset_fault();
  update_after(1ms);
  EXPECT_FALSE(node.heartbeat_lost());
}

// What is told to a drive without power, or behind a cable that is out, nobody hears.
TEST_F(OdriveNodeStop, ThatIsNotHeardWhenItIsResetIsToldToClearAsSoonAsItIs) {
  make_ready();
  update_after(251ms);
  ASSERT_FALSE(node.heard());
  node.reset_fault();
  update_after(1ms);
  EXPECT_FALSE(next());
  heartbeat(AxisState::undefined, error::missing_input);
  EXPECT_FALSE(next()) << "it still starts";
  heartbeat(AxisState::idle, error::missing_input);
  EXPECT_EQ(next(), clear_errors_frame(asked_node));
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version));
}

TEST_F(OdriveNodeStop, OfOldFirmwareIsAskedAgainWhenItIsReset) {
  heartbeat(AxisState::idle);
  update_after(1ms);
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version));
  version(0, 5);
  node.reset_fault();
  update_after(1ms);
  EXPECT_FALSE(node.refused());
  heartbeat(AxisState::idle);
  EXPECT_EQ(next(), clear_errors_frame(asked_node));
  EXPECT_EQ(next(), request_frame(asked_node, Command::get_version)) << "its update may have come";
}

TEST_F(OdriveNodeStop, ThatIsEnabledHasNothingToReset) {
  make_follow();
  node.reset_fault();
  update_after(1ms);
  EXPECT_TRUE(node.follows());
  EXPECT_FALSE(next());
  make_ready();
  node.request_enable();
  node.reset_fault();
  update_after(1ms);
  EXPECT_TRUE(node.wished());
  EXPECT_EQ(next(), mode);
}

TEST_F(OdriveNodeStop, TakesTheReasonOfADisarmingToTheLastPeriod) {
  make_follow();
  heartbeat(AxisState::idle);
  update_after(1ms);
  for (int period = 1; period < 5; ++period) update_after(1ms);
  ASSERT_TRUE(node.wished());
  errors(0, error::estop_requested);
  EXPECT_EQ(node.code(), error_code(error::estop_requested));
}

TEST_F(OdriveNodeStop, ThatStartsAgainIsNotWishedEnabledAnyMore) {
  make_follow();
  heartbeat(AxisState::undefined);
  EXPECT_FALSE(node.wished());
  EXPECT_TRUE(node.take_reboot());
}

// What the drive says next counts again.
TEST_F(OdriveNodeStop, ThatIsResetHasNoErrorUntilItsNextHeartbeat) {
  make_ready();
  heartbeat(AxisState::idle, error::missing_input);
  update_after(1ms);
  ASSERT_EQ(node.code(), error_code(error::missing_input));
  node.reset_fault();
  update_after(1ms);
  EXPECT_EQ(node.code(), 0);
  heartbeat(AxisState::idle, error::missing_input);
  EXPECT_EQ(node.code(), error_code(error::missing_input));
}

}  // namespace
}  // namespace breakaway::odrive::test
