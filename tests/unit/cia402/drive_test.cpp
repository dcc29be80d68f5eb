// Enabling, stopping, faults and what the bus loses.
#include "drive_fixture.hpp"

namespace breakaway::test {
namespace {

TEST_F(DriveTest, IsBeingSetUpBeforeItsFirstPeriod) { EXPECT_EQ(drive.feedback().state, DriveState::configuring); }

TEST_F(DriveTest, WalksToEnabledAndSendsTheForceInPerMille) {
  enable();
  step(10.0F);
  EXPECT_EQ(node.controlword, 0x0F);
  EXPECT_EQ(node.target, 200);
  step(-1e9F);
  EXPECT_EQ(node.target, -1200);
}

TEST_F(DriveTest, ForceIsZeroWithoutANewCommand) {
  enable();
  step(10.0F);
  step();
  EXPECT_EQ(node.target, 0);
}

TEST_F(DriveTest, ForceIsZeroUnlessEnabled) {
  set_up();
  step(10.0F);
  EXPECT_EQ(node.target, 0);
  drive.request_enable();
  while (feedback.state != DriveState::enabled) {
    ASSERT_EQ(node.target, 0);
    step(10.0F);
    ASSERT_LT(now, Time{3s});
  }
  EXPECT_EQ(node.target, 200);
  drive.request_stop();
  step(10.0F);
  EXPECT_EQ(node.target, 0);
  EXPECT_EQ(node.controlword, 0x02);
}

TEST_F(DriveTest, NotANumberIsNoForce) {
  enable();
  step(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(node.target, 0);
}

TEST_F(DriveTest, StopsAndEnablesAgain) {
  enable();
  drive.request_stop();
  run_until_state(DriveState::stopping);
  node.state = State::switch_on_disabled;  // the quick stop is over
  run_until_state(DriveState::disabled);
  run_for(20ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, SilentDropStaysOffUntilEnabledAgain) {
  enable();
  node.state = State::switched_on;
  step(10.0F);
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(node.target, 0);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, FaultIsLatchedNamedAndReset) {
  enable();
  node.state = State::fault;
  node.emergency(0x8611);
  run_until_state(DriveState::fault);
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::fault);
  EXPECT_EQ(feedback.fault_code, 0x8611);
  drive.request_enable();
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::fault);
  drive.reset_fault();
  run_until_state(DriveState::disabled);
  EXPECT_EQ(feedback.fault_code, 0);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

// A feedback tells of what came until it is asked for.
TEST_F(DriveTest, FeedbackIsOfTheNewestWishAndStatusword) {
  enable();
  drive.request_stop();
  EXPECT_EQ(drive.feedback().state, DriveState::stopping);
  run_until_state(DriveState::disabled);
  node.state = State::fault_reaction_active;
  node.on_frame(breakaway::canopen::sync_frame());
  deliver();
  EXPECT_EQ(drive.feedback().state, DriveState::stopping);
}

// A reset acknowledges what was there when it was asked for.
TEST_F(DriveTest, AResetOfADriveWithoutAFaultClearsNoneThatComesInTheSetUpWhichFollows) {
  set_up();
  drive.reset_fault();
  run_until_state(DriveState::configuring);
  node.state = State::fault;
  run_until_state(DriveState::fault);
  run_for(2s);
  EXPECT_EQ(feedback.state, DriveState::fault);
  drive.reset_fault();
  run_until_state(DriveState::disabled);
}

TEST_F(DriveTest, AnotherResetInTheSetUpThatOneBroughtClearsNoLaterFaultEither) {
  set_up();
  drive.reset_fault();
  run_until_state(DriveState::configuring);
  run_until([&] { return drive.cia402_state().has_value(); });
  ASSERT_EQ(feedback.state, DriveState::configuring);
  drive.reset_fault();
  step();
  node.state = State::fault;
  run_until_state(DriveState::fault);
  run_for(2s);
  EXPECT_EQ(feedback.state, DriveState::fault);
}

TEST_F(DriveTest, AResetOfADriveThatIsNotHeardClearsTheFaultThatItShowsWhenItIs) {
  set_up();
  node.silent = true;  // its cable, and that is a fault of the drive's, too
  run_for(1s);
  ASSERT_EQ(feedback.state, DriveState::configuring);
  node.state = State::fault;
  drive.reset_fault();
  run_for(10ms);
  node.silent = false;
  run_until_state(DriveState::disabled);
}

// Another tool may have switched its heartbeat off after the set-up had switched it on.
TEST_F(DriveTest, AResetOfADriveWhoseHeartbeatWasLostInItsSetUpBeginsThatAnew) {
  struct Place {
    const char* name;
    void (*stop_at)(ScriptedDrive&);
  };
  for (const auto& [place, stop_at] :
       {Place{"not started", [](ScriptedDrive& scripted) { scripted.ignores_start = true; }},
        Place{"shows no mode", [](ScriptedDrive& scripted) { scripted.kept[ScriptedDrive::key(0x6061, 0)] = 0; }}}) {
    SCOPED_TRACE(place);
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    stop_at(node);
    node.boot();
    deliver();
    run_until([&] { return !node.commands.empty() && node.commands.back() == NmtCommand::start; });
    run_for(50ms);
    node.objects[ScriptedDrive::key(0x1017, 0)] = 0;
    run_until([&] { return drive.heartbeat_lost(); });
    drive.reset_fault();
    step();
    EXPECT_FALSE(drive.heartbeat_lost());
    node.ignores_start = false;
    node.kept.clear();
    node.objects[ScriptedDrive::key(0x6061, 0)] = 10;
    run_until_state(DriveState::disabled);
    EXPECT_EQ(node.value_of(0x1017, 0), 100U);
  }
}

// Another tool may have changed the set-up, so that no reset would ever reach the drive.
TEST_F(DriveTest, AResetSetsTheDriveUpAnewFirst) {
  node.shows_the_mode_at_once = true;
  const auto key = ScriptedDrive::key;
  struct Tampering {
    std::uint32_t object, value;
  };
  for (const auto& [object, value] :
       {Tampering{key(0x1400, 1), 0x80000204}, Tampering{key(0x1800, 1), 0x80000184}, Tampering{key(0x1005, 0), 0x81},
        Tampering{key(0x60B2, 0), 600}, Tampering{key(0x6061, 0), 1}}) {
    enable();
    node.state = State::fault;
    run_until_state(DriveState::fault);
    node.objects[object] = value;
    run_for(20ms);
    drive.reset_fault();
    run_until_state(DriveState::configuring);
    run_until_state(DriveState::disabled);
    EXPECT_NE(node.objects[object], value);
    run_for(50ms);
    EXPECT_EQ(feedback.state, DriveState::disabled) << "not enabled without a request";
    drive.request_enable();
    run_until_state(DriveState::enabled);
    drive.request_stop();
    node.state = State::switch_on_disabled;
    run_for(10ms);
  }
}

TEST_F(DriveTest, AResetOfADriveThatIsEnabledChangesNothing) {
  enable();
  node.written.clear();
  drive.reset_fault();
  run_for(100ms);
  EXPECT_EQ(feedback.state, DriveState::enabled);
  EXPECT_TRUE(node.written.empty());
}

TEST_F(DriveTest, AResetOfADriveThatIsOnItsWayToEnabledTakesNothingBack) {
  set_up();
  node.follows_controlword = false;
  drive.request_enable();
  run_for(20ms);
  ASSERT_EQ(feedback.state, DriveState::enabling);
  drive.reset_fault();
  run_for(20ms);
  EXPECT_EQ(feedback.state, DriveState::enabling);
  node.follows_controlword = true;
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, AResetGivesARefusedDriveAnotherChance) {
  node.refused[ScriptedDrive::key(0x1A00, 2)] = SdoAbort::not_mappable;
  node.boot();
  deliver();
  run_until_state(DriveState::unusable);
  node.refused.clear();
  run_for(1s);
  EXPECT_EQ(feedback.state, DriveState::unusable);
  drive.reset_fault();
  run_until_state(DriveState::disabled);
}

TEST_F(DriveTest, AFaultWhoseCauseRemainsIsStillOneAfterTheReset) {
  enable();
  node.state = State::fault;
  run_until_state(DriveState::fault);
  node.follows_controlword = false;
  drive.reset_fault();
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::fault);
  EXPECT_EQ(feedback.fault_code, 0);
  run_until([&] { return feedback.fault_code == 0x2310; });
}

TEST_F(DriveTest, ADriveWhoseStateNoPdoTellsIsNotLedAnywhere) {
  node.kept[ScriptedDrive::key(0x1800, 1)] = 0x80000184;  // its TPDO stays off
  node.boot();
  deliver();
  run_until_state(DriveState::disabled);
  drive.request_enable();
  run_for(500ms);
  EXPECT_NE(feedback.state, DriveState::enabled);
  EXPECT_EQ(node.controlword, 0);
  EXPECT_EQ(node.state, State::switch_on_disabled);
}

// A statusword of Fault and Switch on disabled at once.
TEST_F(DriveTest, ADriveWhoseStatuswordIsOfNoStateIsBeingConfiguredAndNotLedAnywhere) {
  node.kept[ScriptedDrive::key(0x6041, 0)] = 0x48;
  node.extra_status = 0x08;
  node.boot();
  deliver();
  run_until([&] { return drive.setup_status() == SetupStatus::ready && feedback.fresh; });
  EXPECT_EQ(drive.statusword(), 0x0258);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  drive.request_enable();
  run_for(500ms);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_EQ(node.controlword, 0);
  node.extra_status = 0;
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, FaultWithoutEmergencyIsAskedForItsCode) {
  enable();
  node.state = State::fault;
  run_until([&] { return feedback.fault_code != 0; });
  EXPECT_EQ(feedback.fault_code, 0x2310);
}

TEST_F(DriveTest, RebootIsReportedAndSetUpAnewButNotEnabled) {
  enable();
  node.boot();
  deliver();
  step(10.0F);
  EXPECT_EQ(feedback.state, DriveState::configuring);
  EXPECT_FALSE(feedback.ever_valid);
  EXPECT_EQ(drive.reboots(), 1U);
  run_until_state(DriveState::disabled);
  run_for(200ms);
  EXPECT_EQ(feedback.state, DriveState::disabled);
}

TEST_F(DriveTest, HeartbeatLossIsSeenAndPasses) {
  enable();
  node.silent = true;
  const Time begin = now;
  run_until([&] { return drive.heartbeat_lost(); });
  EXPECT_GE(now - begin, 150ms);
  EXPECT_LE(now - begin, 252ms);
  node.silent = false;
  run_until([&] { return !drive.heartbeat_lost(); });
  EXPECT_EQ(feedback.state, DriveState::enabled) << "what to do about it is the supervisor's";
}

TEST_F(DriveTest, NodeThatLeavesOperationalIsStartedAgainButNotEnabled) {
  enable();
  node.nmt = NmtState::pre_operational;
  node.state = State::switch_on_disabled;
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(node.nmt, NmtState::operational);
  EXPECT_EQ(drive.reboots(), 0U);
}

// It says its heartbeat without being told to, and its boot-up was lost.
TEST_F(DriveTest, OneThatRebootsUnheardAndSaysSoByItsHeartbeatOnlyHasLostItsReference) {
  for (const bool enabled : {false, true}) {
    for (const Duration silence : {0ms, 20ms, 1000ms}) {
      drive = Drive<float>{config, network, scale};
      node = ScriptedDrive{node_id};
      node.saves_its_heartbeat = true;
      enabled ? enable() : set_up();
      node.silent = true;
      node.boots_silently = true;
      node.boot();
      run_for(silence);
      ASSERT_FALSE(drive.reference_lost());
      node.silent = false;
      run_until([&] { return drive.reference_lost(); });
      EXPECT_EQ(drive.reboots(), 1U);
      node.boots_silently = false;
      run_until_state(DriveState::disabled);
      EXPECT_EQ(drive.reboots(), 1U) << enabled << ", silent for " << silence / 1ms << " ms";
      EXPECT_EQ(node.objects.at(ScriptedDrive::key(0x1016, 1)), 0x7F00FAU) << "it was set up again";
    }
  }
}

TEST_F(DriveTest, OneThatIsFoundWithoutABootUpHasNotRebooted) {
  node.boots_silently = true;
  node.boot();
  node.heartbeat();
  deliver();
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.reboots(), 0U);
  EXPECT_FALSE(drive.reference_lost());
}

TEST_F(DriveTest, OneThatCannotShowWhoItsMasterIsIsNotTakenForRebooted) {
  for (const bool has_another : {false, true}) {
    drive = Drive<float>{config, network, scale};
    node = ScriptedDrive{node_id};
    if (has_another)
      node.kept[ScriptedDrive::key(0x1016, 1)] = 0x7E0064;
    else
      node.refused[ScriptedDrive::key(0x1016, 1)] = SdoAbort::no_such_object;
    enable();
    node.written.clear();
    node.nmt = NmtState::pre_operational;
    node.state = State::switch_on_disabled;
    run_until_state(DriveState::configuring);
    run_until_state(DriveState::disabled);
    EXPECT_EQ(drive.reboots(), 0U);
    EXPECT_GT(node.written.size(), 20U) << "but it is set up anew, because nobody knows";
    drive.request_enable();
    run_until_state(DriveState::enabled);
  }
}

// Its boot-up was lost, and it produces no heartbeat before it is told to.
TEST_F(DriveTest, OneThatRebootsUnheardWhileItStandsDisabledIsSetUpAnew) {
  set_up();
  node.silent = true;
  node.boot();
  node.silent = false;
  run_until_state(DriveState::configuring);
  run_until_state(DriveState::disabled);
  EXPECT_EQ(drive.reboots(), 1U) << "the boot-up that it was made to say";
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, OneThatRebootsUnheardWhileItIsStartedIsSetUpAnew) {
  set_up();
  node.nmt = NmtState::stopped;
  run_until_state(DriveState::configuring);
  node.silent = true;
  node.boot();
  node.silent = false;
  run_until([&] { return feedback.state == DriveState::disabled; }, 6s);
  drive.request_enable();
  run_until_state(DriveState::enabled);
}

TEST_F(DriveTest, OtherNodesFramesChangeNothing) {
  enable();
  const auto before = drive.statusword();
  constexpr std::uint8_t other = node_id + 1;
  for (const std::uint16_t id :
       {tpdo_cob_id(1, other), emcy_cob_id(other), sdo_response_cob_id(other), heartbeat_cob_id(other),
        tpdo_cob_id(2, node_id), rpdo_cob_id(1, node_id), sdo_request_cob_id(node_id)})
    drive.on_frame({.frame = {.id = id, .size = 8, .data = {0x08, 0, 0, 0, 0, 0, 0, 0}}, .time = now});
  step();
  EXPECT_EQ(drive.statusword(), before);
  EXPECT_EQ(feedback.state, DriveState::enabled);
  EXPECT_EQ(drive.last_emcy().code, 0);
}

TEST_F(DriveTest, DriveThatStayedEnergisedOutsideOfOperationalIsSwitchedOff) {
  enable();
  node.nmt = NmtState::pre_operational;  // but still in Operation enabled
  run_until_state(DriveState::configuring);
  while (feedback.state == DriveState::configuring) {
    step(10.0F);
    ASSERT_EQ(node.target, 0);
    ASSERT_LT(now, Time{3s});
  }
  EXPECT_EQ(feedback.state, DriveState::disabled);
  EXPECT_EQ(node.state, State::switch_on_disabled);
}

}  // namespace
}  // namespace breakaway::test
