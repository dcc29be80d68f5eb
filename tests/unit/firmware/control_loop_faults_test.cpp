// What stops an axis of the loop, by which name, and what a reset does.
#include "breakaway/firmware/control_loop.hpp"

#include <gtest/gtest.h>

#include "control_loop_fixture.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using testing::ControlLoopTest;
using testing::DriveProbe;
using testing::Loop;

TEST_F(ControlLoopTest, ALawThatSaysNothingOfItsFrictionMayTakeAsLongAsItLikes) {
  enable();
  probe.feedback.position_offset_m = 0.01F;
  run_for(61s);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
}

TEST_F(ControlLoopTest, NamesTheFaultOfTheLawAndStopsTheDrive) {
  DriveProbe other;
  testing::ProportionalLaw jammed;
  jammed.fault_ = law::ControlFault::jammed;
  const auto id = *loop.add_axis({&other, 2}, jammed, testing::moderate_limits()).id;
  loop.request_enable(id);
  other.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
  for (int i = 0; i < 2; ++i) {
    other.feedback.sample_time = now;
    step();
  }
  EXPECT_EQ(loop.status(id).fault, AxisFault::axis_jammed);
  EXPECT_EQ(other.stops, 1);
  EXPECT_FALSE(loop.status(id).running);
}

// The error that stands when the axis is enabled is the one that it may have.
TEST_F(ControlLoopTest, WatchesTheFollowingErrorFromTheFirstStepOn) {
  for (const float sign : {1.0F, -1.0F}) {
    auto limits = testing::moderate_limits();
    limits.following_error_m = 0.01F;
    DriveProbe other;
    Loop watched{port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
    const auto id = *watched.add_axis({&other, 1}, {}, limits).id;
    watched.request_enable(id);
    other.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
    const auto at = [&](float offset_m) {
      now += 1ms;
      other.feedback.sample_time = now;
      other.feedback.position_offset_m = sign * offset_m;
      watched.step(now);
      return watched.status(id).fault;
    };
    EXPECT_EQ(at(0.05F), AxisFault::none);
    EXPECT_EQ(at(0.0599F), AxisFault::none);
    EXPECT_EQ(at(0.0601F), AxisFault::following_error);
  }
}

TEST_F(ControlLoopTest, StopsTheDriveInTheStepThatSeesTheFault) {
  enable();
  const auto commands = probe.commands.size();
  probe.heartbeat_lost = true;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::heartbeat_lost);
  EXPECT_EQ(probe.stops, 1);
  EXPECT_EQ(probe.commands.size(), commands) << "no force without a command";
  probe.heartbeat_lost = false;
  for (int i = 0; i < 10; ++i) step();
  EXPECT_EQ(probe.commands.size(), commands) << "latched";
  EXPECT_FALSE(loop.status(axis).running);
  reset_once_without_force();
  EXPECT_EQ(probe.resets, 1);
  enable();
}

TEST_F(ControlLoopTest, RefusesAResetUntilTheDriveIsSeenWithoutForce) {
  enable();
  probe.heartbeat_lost = true;
  step();
  probe.heartbeat_lost = false;
  for (const auto state : {hal::DriveState::enabled, hal::DriveState::stopping}) {
    probe.feedback.state = state;
    step();
    EXPECT_FALSE(loop.reset_fault(axis));
    EXPECT_EQ(loop.status(axis).fault, AxisFault::heartbeat_lost);
    EXPECT_EQ(probe.resets, 0);
  }
  for (const auto state : {hal::DriveState::disabled, hal::DriveState::configuring, hal::DriveState::fault}) {
    probe.feedback.state = state;
    step();
    EXPECT_TRUE(loop.reset_fault(axis)) << "no force in this state";
  }
}

TEST_F(ControlLoopTest, AResetWithoutAFaultDoesNotReachTheDrive) {
  probe.feedback.state = hal::DriveState::disabled;
  step();
  EXPECT_TRUE(loop.reset_fault(axis));
  EXPECT_EQ(probe.resets, 0);
}

TEST_F(ControlLoopTest, NamesADriveThatIsNeverEnabledAndTriesAgainAfterAReset) {
  loop.request_enable(axis);
  probe.feedback.state = hal::DriveState::enabling;
  run_for(5s + 1ms);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "a power stage may take this long";
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::enable_timed_out);
  EXPECT_GE(probe.stops, 1) << "and it shall not be enabled unnamed, later";
  const int enables = probe.enables;
  reset_once_without_force();
  step();
  EXPECT_EQ(probe.enables, enables + 1);
  probe.feedback.state = hal::DriveState::enabling;
  run_for(4s);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "the time begins anew";
}

TEST_F(ControlLoopTest, GivesADriveTheWholeTimeAgainWhereItIsResetOnItsWay) {
  loop.request_enable(axis);
  probe.feedback.state = hal::DriveState::enabling;
  run_for(5002ms);
  ASSERT_EQ(loop.status(axis).fault, AxisFault::enable_timed_out);
  EXPECT_TRUE(loop.reset_fault(axis));
  run_for(4s);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
}

TEST_F(ControlLoopTest, CountsTheTimeOfAResetFromTheEndOfTheSetUp) {
  probe.feedback.state = hal::DriveState::fault;
  step();
  ASSERT_TRUE(loop.reset_fault(axis));
  probe.feedback.state = hal::DriveState::configuring;
  run_for(3s);
  probe.feedback.state = hal::DriveState::fault;
  run_for(900ms);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  run_for(200ms);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::drive_fault);
}

// Three controlwords of each level, and the answer of a drive that takes two periods for each.
TEST(ASlowLoop, GivesAResetThePeriodsThatItTakes) {
  testing::FakePort port;
  DriveProbe probe;
  testing::Loop loop{port, {.network = {.period = 250ms, .heartbeat_period = 0ms}}};
  const auto axis = *loop.add_axis({&probe, 1}, {.period = 0.25F}, testing::moderate_limits()).id;
  hal::Time now{};
  const auto run = [&](int periods) {
    for (int i = 0; i < periods; ++i) loop.step(now += 250ms);
  };
  probe.feedback.state = hal::DriveState::fault;
  run(1);
  ASSERT_TRUE(loop.reset_fault(axis));
  run(19);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  run(1);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::drive_fault);
}

TEST_F(ControlLoopTest, CountsTheTimeOfOneWishToEnable) {
  loop.request_enable(axis);
  for (int wish = 0; wish < 4; ++wish) {
    probe.feedback.state = hal::DriveState::enabling;
    run_for(4s);
    probe.feedback.state = hal::DriveState::configuring;
    step();
  }
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  probe.feedback.state = hal::DriveState::enabling;
  run_for(4100ms);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::enable_timed_out) << "it goes round and round";
  loop.request_stop(axis);
  reset_once_without_force();
  probe.feedback.state = hal::DriveState::enabling;
  run_for(10s);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "nobody waits for it";
}

TEST_F(ControlLoopTest, LimitsTheReportedForceToAFifthAboveTheLawsUnlessToldOtherwise) {
  for (const float sign : {1.0F, -1.0F}) {
    enable();
    probe.feedback.force_N = sign * 59.9F;
    step();
    EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "a current loop overshoots";
    probe.feedback.force_N = sign * 60.1F;
    step();
    EXPECT_EQ(loop.status(axis).fault, AxisFault::force_limit);
    probe.feedback.force_N = 0;
    reset_once_without_force();
  }
  DriveProbe other;
  const auto told = *loop.add_axis({&other, 2}, {}, {.force_N = 55}).id;
  loop.request_enable(told);
  other.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
  other.feedback.sample_time = now;
  step();
  other.feedback.force_N = 55.1F;
  other.feedback.sample_time = now;
  step();
  EXPECT_EQ(loop.status(told).fault, AxisFault::force_limit);
}

TEST_F(ControlLoopTest, NamesAStopThatIsNotObeyedAndRefusesAResetUntilItIs) {
  enable();
  loop.request_stop(axis);
  probe.feedback.state = hal::DriveState::stopping;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  probe.feedback.stop_not_obeyed = true;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::stop_not_obeyed);
  EXPECT_TRUE(loop.status(axis).stop_not_obeyed);
  EXPECT_FALSE(loop.reset_fault(axis));
  EXPECT_EQ(probe.resets, 0);
  probe.feedback.stop_not_obeyed = false;
  probe.feedback.state = hal::DriveState::disabled;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::stop_not_obeyed) << "latched";
  EXPECT_TRUE(loop.reset_fault(axis));
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  EXPECT_FALSE(loop.status(axis).stop_not_obeyed);
}

TEST_F(ControlLoopTest, TellsOfAStopThatIsNotObeyedBesideTheFaultThatBroughtIt) {
  enable();
  probe.heartbeat_lost = true;
  step();
  probe.feedback.stop_not_obeyed = true;
  probe.feedback.state = hal::DriveState::stopping;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::heartbeat_lost) << "what came first";
  EXPECT_TRUE(loop.status(axis).stop_not_obeyed);
}

TEST_F(ControlLoopTest, StopsADriveWhoseForceNobodyCommanded) {
  enable();
  probe.feedback.force_N = 20;  // the law asks for none
  int steps = 0;
  while (loop.status(axis).fault == AxisFault::none && steps < 100) {
    probe.feedback.fresh = true;
    step();
    ++steps;
  }
  EXPECT_EQ(loop.status(axis).fault, AxisFault::force_not_commanded);
  EXPECT_LE(steps, CommandedForce<float>::patience + 1);
  EXPECT_EQ(probe.stops, 1);
}

TEST_F(ControlLoopTest, PassesEmergenciesOnOnce) {
  enable();
  probe.emcy.code = 0x2310;
  probe.new_error = 0x2310;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::emergency);
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0x2310);
  reset_once_without_force();
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "an old message is no new emergency";
}

TEST_F(ControlLoopTest, NamesAnotherMasterByWhatItSends) {
  const auto sdo = [](std::uint8_t command, std::uint8_t node) {
    return hal::CanFrame{.id = canopen::sdo_request_cob_id(node), .size = 8, .data = {command}};
  };
  struct Sent {
    hal::CanFrame frame;
    bool by_a_master;
  };
  for (const Sent& sent :
       {Sent{canopen::sync_frame(), true}, Sent{canopen::heartbeat_frame(canopen::NmtState::operational, 127), true},
        Sent{canopen::heartbeat_frame(canopen::NmtState::operational, 1), false}, Sent{sdo(0x23, 1), true},
        Sent{sdo(0x21, 1), true}, Sent{sdo(0xC2, 1), true}, Sent{sdo(0x40, 1), false}, Sent{sdo(0x23, 2), false}}) {
    enable();
    port.to_receive.push_back({sent.frame, now});
    step();
    EXPECT_EQ(loop.status(axis).fault, sent.by_a_master ? AxisFault::another_master : AxisFault::none);
    reset_once_without_force();
    step();
    EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "it is gone";
  }
}

TEST_F(ControlLoopTest, NamesWhatKeepsAnIdleAxisFromRunningOnlyWhereItIsWanted) {
  probe.feedback.state = hal::DriveState::configuring;
  probe.heartbeat_lost = true;
  run_for(30s);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  loop.request_enable(axis);
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::heartbeat_lost);
  EXPECT_EQ(probe.stops, 1) << "a wish that was passed on is taken back";
  probe.heartbeat_lost = false;
  reset_once_without_force();
  probe.feedback.state = hal::DriveState::configuring;
  run_for(20s + 1ms);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::enable_timed_out);
}

// A drive whose answers take their time, and whose set-up takes its turns.
struct SlowDrive : testing::FakeDrive {
  using FakeDrive::FakeDrive;
  static constexpr int setup_periods = 100;
  static hal::Duration extra_setup_time() noexcept { return 7s; }
};

TEST(SlowDriveInALoop, HasTheTimeThatItsAnswersTakeBesideThatOfEveryDrive) {
  testing::FakePort port;
  DriveProbe probe;
  ControlLoop<testing::FakePort, SlowDrive, testing::ProportionalLaw, float> loop{
      port, {.network = {.period = 1ms, .heartbeat_period = 0ms}}};
  DriveProbe other;
  const auto id = *loop.add_axis({&probe, 1}, {}, testing::moderate_limits()).id;
  ASSERT_TRUE(loop.add_axis({&other, 2}, {}, testing::moderate_limits()).id);
  probe.feedback.state = hal::DriveState::configuring;
  loop.request_enable(id);
  hal::Time now{};
  for (const hal::Time end = now + 27s + 201ms; now < end;) loop.step(now += 1ms);
  EXPECT_EQ(loop.status(id).fault, AxisFault::none) << "20 s, 7 s for its answers, and 100 periods for each axis";
  loop.step(now += 1ms);
  EXPECT_EQ(loop.status(id).fault, AxisFault::enable_timed_out);
}

TEST_F(ControlLoopTest, NamesADriveThatDoesNotComeByTheErrorThatItToldOf) {
  loop.request_enable(axis);
  probe.feedback.state = hal::DriveState::configuring;
  probe.emcy.code = 0x8120;
  run_for(20'002ms);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::emergency);
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0x8120);
}

TEST_F(ControlLoopTest, AFaultThatItsCallerSeesStopsAWantedAxisByThatName) {
  loop.stop_with(axis, AxisFault::commander_lost, now);
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "it was not wanted";
  enable();
  loop.stop_with(axis, AxisFault::commander_lost, now);
  EXPECT_EQ(probe.stops, 2);
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::commander_lost);
  EXPECT_FALSE(loop.status(axis).running);
  reset_once_without_force();
  const int enables = probe.enables;
  run_for(100ms);
  EXPECT_EQ(probe.enables, enables) << "and it is wanted no longer";
}

TEST_F(ControlLoopTest, TakesAReferenceOnlyForAnAxisThatIsSeenWithoutForce) {
  step();
  EXPECT_FALSE(loop.set_reference_counts(axis, 7)) << "no sample came";
  enable();
  EXPECT_FALSE(loop.set_reference_counts(axis, 7));
  probe.feedback.state = hal::DriveState::disabled;
  step();
  EXPECT_TRUE(loop.set_reference_counts(axis, 7));
  EXPECT_EQ(probe.reference, 7);
}

// The axis of a drive that is set up anew may move on meanwhile, and its newest sample says nothing of where it is.
TEST_F(ControlLoopTest, TakesNoReferenceWhileNoSampleSaysWhereTheAxisIs) {
  enable();
  probe.feedback.state = hal::DriveState::configuring;
  now += 1400us;
  loop.step(now);
  EXPECT_TRUE(loop.set_reference_counts(axis, 7));
  now += 200us;
  loop.step(now);
  EXPECT_FALSE(loop.set_reference_counts(axis, 8));
  EXPECT_EQ(probe.reference, 7);
  probe.feedback.state = hal::DriveState::disabled;
  step();
  EXPECT_TRUE(loop.set_reference_counts(axis, 8));
}

TEST_F(ControlLoopTest, NamesADriveThatIsInFaultBeforeItEverRan) {
  probe.feedback.state = hal::DriveState::fault;
  probe.feedback.fault_code = 0x3210;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::drive_fault);
  EXPECT_EQ(loop.supervisor(axis).fault_code(), 0x3210);
  loop.reset_fault(axis);
  for (int i = 0; i < 900; ++i) step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "a reset takes the drive some time";
  for (int i = 0; i < 200; ++i) step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::drive_fault) << "this one did not help";
}

TEST_F(ControlLoopTest, StopsOnBusOff) {
  enable();
  port.state = hal::BusState::bus_off;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::bus_off);
  EXPECT_GE(port.purges, 1);
}

TEST_F(ControlLoopTest, GivesADriveTwoAndAHalfPeriodsForASampleUnlessToldOtherwise) {
  enable();
  probe.feedback.fresh = false;
  now += 2ms;
  step();
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none) << "the sample is one period old";
  probe.feedback.sample_time = now - 2400us;
  loop.step(now);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::none);
  probe.feedback.sample_time = now - 2600us;
  port.sent.clear();
  loop.step(now);
  EXPECT_EQ(loop.status(axis).fault, AxisFault::feedback_stale);
}

}  // namespace
}  // namespace breakaway::firmware
