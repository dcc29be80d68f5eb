// Force that nobody here wishes: one statusword proves nothing, and a drive of no use to us is watched like any other.
#include <gtest/gtest.h>

#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;

// Within that time, by a user who takes every name for granted and resets what can be reset.
void expect_to_run(Rig& rig, hal::Duration limit) {
  const hal::Time end = rig.now() + limit;
  do {
    rig.step();
    if (rig.status(0).fault != AxisFault::none) static_cast<void>(rig.loop().reset_fault(rig.id(0)));
  } while (!rig.status(0).running && rig.now() < end);
  EXPECT_TRUE(rig.status(0).running) << to_string(rig.status(0).fault);
}

// Late in the period, after the drive's own: by a second node on its id, or a gateway that repeats what it once had.
void step_with_a_lie(Rig& rig, sil::SimulatedNetwork::Port& liar) {
  constexpr hal::CanFrame switched_off{.id = 0x181, .size = 8, .data = {0x40, 0x02}};
  rig.network().finish_period(rig.loop());
  rig.network().advance_to(rig.now() + 700us);
  ASSERT_EQ(liar.send(switched_off, rig.now() + 1ms), hal::SendResult::queued);
  rig.step();
}

TEST(ForeignForce, ASampleWithoutForceNowAndThenNeitherKeepsItOnNorLetsAResetThrough) {
  for (const int every : {1, 2, 5, 10, 19, 20, 21, 22, 40}) {
    Rig rig{far_from_target()};
    ASSERT_TRUE(rig.start());
    rig.run(20ms);
    rig.write_to_drive(0x1400, 1, 0x80000201, 4);
    rig.loop().request_stop(rig.id(0));
    auto& liar = rig.network().add_port();
    int with_force = 0;
    for (int i = 1; i <= 200; ++i) {
      if (i % every == 0)
        ASSERT_NO_FATAL_FAILURE(step_with_a_lie(rig, liar));
      else
        rig.step();
      if (std::abs(rig.force_N(0)) < 0.1) continue;
      ++with_force;
      EXPECT_FALSE(rig.loop().reset_fault(rig.id(0))) << i << " of every " << every;
    }
    // The time of a stop, up to a lie's distance more where one comes as it ends, and the answers by SDO.
    EXPECT_LE(with_force, 45) << "a lie every " << every;
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
    EXPECT_TRUE(rig.status(0).stop_not_obeyed);
    EXPECT_NE(rig.status(0).fault, AxisFault::none);
  }
}

// Between our command and its SYNC, so that it is theirs on which the drive acts.
TEST(ForeignForce, AnotherMastersCommandsAreNamedAndTheDriveIsKeptFromThem) {
  Rig rig{far_from_target()};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  auto& other = rig.network().add_port();
  constexpr hal::CanFrame full_force{.id = 0x201, .size = 8, .data = {0x0F, 0x00, 0xE8, 0x03}};
  int with_force = 0;
  for (int i = 0; i < 10'000; ++i) {
    rig.network().advance_to(rig.now() + 120us);
    ASSERT_EQ(other.send(full_force, rig.now() + 1ms), hal::SendResult::queued);
    rig.step();
    EXPECT_TRUE(i < 2 || rig.status(0).fault == AxisFault::another_master) << i;
    EXPECT_LE(std::abs(rig.force_N(0)), 50);
    if (std::abs(rig.force_N(0)) > 0.1) ++with_force;
  }
  EXPECT_LE(with_force, 30) << "of 10,000 periods";
  EXPECT_EQ(rig.status(0).fault, AxisFault::another_master);
  rig.run(100ms);
  ASSERT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_TRUE(rig.status(0).running);
}

// Held in Pre-operational, it is started again by whoever commands it.
TEST(ForeignForce, AHeldDriveThatSomebodyStartsAgainIsTakenBackAndAResetWaits) {
  for (const int every : {10, 50}) {
    Rig rig{far_from_target()};
    ASSERT_TRUE(rig.start());
    rig.run(20ms);
    auto& other = rig.network().add_port();
    int with_force = 0, longest = 0, resets = 0;
    for (int i = 0; i < 5000; ++i) {
      // As a master does that follows the statusword.
      const bool disabled = rig.drive(0).state() == cia402::State::switch_on_disabled;
      const hal::CanFrame command{
          .id = 0x201, .size = 8, .data = {static_cast<std::uint8_t>(disabled ? 0x06 : 0x0F), 0x00, 0xE8, 0x03}};
      if (i % every == 0) {
        ASSERT_EQ(other.send(canopen::nmt_frame(canopen::NmtCommand::start, 1), rig.now() + 1ms),
                  hal::SendResult::queued);
      }
      ASSERT_EQ(other.send(command, rig.now() + 1ms), hal::SendResult::queued);
      rig.step();
      with_force = std::abs(rig.force_N(0)) > 0.1 ? with_force + 1 : 0;
      longest = std::max(longest, with_force);
      if (with_force > 0 && rig.loop().reset_fault(rig.id(0))) ++resets;
    }
    EXPECT_GT(longest, 0) << "it was never energised";
    EXPECT_LE(longest, 30) << "started every " << every << " ms";
    EXPECT_EQ(resets, 0) << "started every " << every << " ms";
    rig.run(200ms);
    ASSERT_TRUE(rig.loop().reset_fault(rig.id(0)));
    rig.run(3s);
    EXPECT_TRUE(rig.status(0).running) << to_string(rig.status(0).fault);
  }
}

TEST(ForeignForce, ADriveThatWasRefusedGetsItBackForAFewPeriodsOnlyWhereAToolGoesOn) {
  for (const int every : {2, 5, 20}) {
    RigConfig config;
    config.quirks.refused_objects = {0x6076};
    Rig rig{config};
    rig.run(3s);
    ASSERT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
    int with_force = 0, longest = 0;
    for (int i = 0; i < 5000; ++i) {
      if (i % every == 0) enable_from_elsewhere(rig);
      rig.step();
      with_force = std::abs(rig.force_N(0)) > 0.1 ? with_force + 1 : 0;
      longest = std::max(longest, with_force);
    }
    EXPECT_GT(longest, 0);
    EXPECT_LE(longest, 60) << "every " << every << " ms";
    EXPECT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
  }
}

// Looks take turns, as the rest of the SDO of all axes.
TEST(ForeignForce, SeveralHeldDrivesThatAreEnabledAtOnceGetTheirForceBackForAsManyTurns) {
  struct Case {
    hal::Duration period;
    std::size_t axes;
    hal::Duration limit;
  };
  for (const Case& one : {Case{1ms, 4, 60ms}, Case{10ms, 8, 300ms}}) {
    RigConfig config = far_from_target();
    config.period = one.period;
    config.axes = one.axes;
    Rig rig{config};
    ASSERT_TRUE(rig.start());
    for (std::size_t i = 0; i < one.axes; ++i) {
      const auto node = static_cast<std::uint32_t>(i + 1);
      rig.write_to_drive(0x1400, 1, 0x80000200U + node, 4, i);
      rig.loop().request_stop(rig.id(i));
    }
    rig.run(5s);
    hal::Duration longest{};
    for (int again = 0; again < 20; ++again) {
      for (std::size_t i = 0; i < one.axes; ++i) enable_from_elsewhere(rig, i);
      const hal::Time begin = rig.now();
      const auto energised = [&](std::size_t i) { return std::abs(rig.force_N(i)) > 0.1; };
      const auto any = [&] {
        for (std::size_t i = 0; i < one.axes; ++i)
          if (energised(i)) return true;
        return false;
      };
      while (any() || rig.now() - begin < 3 * one.period) {
        ASSERT_LE(rig.now() - begin, one.limit) << one.axes << " axes";
        rig.step();
      }
      longest = std::max(longest, rig.now() - begin);
      rig.run(507 * one.period);
    }
    EXPECT_GT(longest, one.limit / 3) << one.axes << " axes: the limit says something";
  }
}

// Its set-up showed how long its answers take.
TEST(ForeignForce, ADriveThatAnswersSlowlyIsNotResetForThat) {
  for (const auto delay : {60ms, 90ms}) {
    RigConfig config = far_from_target();
    config.quirks.no_boot_up_message = true;
    config.quirks.sdo_response_delay = delay;
    Rig rig{config};
    rig.loop().request_enable(rig.id(0));
    while (!rig.status(0).running && rig.now() < hal::Time{30s}) rig.step();
    ASSERT_TRUE(rig.status(0).running);
    rig.run(50ms);
    const std::uint32_t reboots = rig.loop().drive(rig.id(0)).reboots();
    rig.write_to_drive(0x1400, 1, 0x80000201, 4);
    rig.write_to_drive(0x1800, 1, 0xC0000181, 4);
    rig.loop().request_stop(rig.id(0));
    rig.run(50ms);
    ASSERT_TRUE(rig.status(0).feedback.stop_not_obeyed);
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
    rig.run(1s);
    EXPECT_FALSE(rig.status(0).feedback.stop_not_obeyed) << delay / 1ms << " ms";
    rig.run(500ms);  // ten answers, of state and torque in turn
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0))) << delay / 1ms << " ms";
    EXPECT_EQ(rig.loop().drive(rig.id(0)).reboots(), reboots);
  }
}

// Slow only since it was set up, and without a word of its boot-up: only its answers say that it is without force.
TEST(ForeignForce, ADriveThatBecameSlowIsForcedToAStopThatEnds) {
  for (const auto delay : {60ms, 400ms, 1500ms}) {
    RigConfig config = far_from_target();
    config.quirks.no_boot_up_message = true;
    Rig rig{config};
    rig.loop().request_enable(rig.id(0));
    expect_to_run(rig, 30s);
    rig.run(50ms);
    rig.write_to_drive(0x1400, 1, 0x80000201, 4);
    rig.write_to_drive(0x1800, 1, 0xC0000181, 4);
    rig.drive(0).delay_sdo_responses(delay);
    rig.loop().request_stop(rig.id(0));
    rig.run(2500ms);
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
    rig.run(20s);
    EXPECT_FALSE(rig.status(0).feedback.stop_not_obeyed) << delay / 1ms << " ms";
    rig.run(10s);  // ten answers, of state and torque in turn
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0))) << delay / 1ms << " ms";
    rig.loop().request_enable(rig.id(0));
    expect_to_run(rig, 3min);
  }
}

// It was set up, and so is known to be slow.
TEST(ForeignForce, ASlowDriveThatRebootsWithoutAWordRunsAgain) {
  for (const auto delay : {200us, 290000us, 320000us, 1000000us}) {
    RigConfig config = far_from_target();
    config.quirks.no_boot_up_message = true;
    config.quirks.sdo_response_delay = delay;
    Rig rig{config};
    rig.loop().request_enable(rig.id(0));
    expect_to_run(rig, 3min);
    rig.drive(0).power_off(rig.now());
    rig.run(50ms);
    rig.drive(0).power_on(rig.now());
    expect_to_run(rig, 5min);
  }
}

TEST(ForeignForce, ADriveThatBootsForLongWithoutAWordAndIsSlowIsSetUpAndForcedToAStopThatEnds) {
  for (const auto boot : {1500ms, 1900ms, 2500ms, 4000ms})
    for (const auto delay : {200us, 400000us, 1000000us}) {
      RigConfig config = far_from_target();
      config.quirks.no_boot_up_message = true;
      config.boot_duration = boot;
      Rig rig{config};
      rig.drive(0).delay_sdo_responses(delay);
      rig.loop().request_enable(rig.id(0));
      expect_to_run(rig, 5min);
      if (testing::Test::HasFailure()) FAIL() << boot / 1ms << " ms, " << delay / 1us << " us";
      rig.run(50ms);
      rig.write_to_drive(0x1400, 1, 0x80000201, 4);
      rig.write_to_drive(0x1800, 1, 0xC0000181, 4);
      rig.drive(0).power_off(rig.now());
      rig.run(3s);
      rig.drive(0).power_on(rig.now());
      expect_to_run(rig, 5min);
      if (testing::Test::HasFailure()) FAIL() << boot / 1ms << " ms, " << delay / 1us << " us, again";
    }
}

// In NMT Stopped it hears no SDO, and keeps what force it has.
TEST(ForeignForce, ADriveThatSomebodyElseStopsByNmtIsTakenBack) {
  for (const bool refused : {false, true})
    for (const bool enabled : {false, true})
      for (const auto after : {2ms, 30ms, 70ms, 150ms}) {
        RigConfig config = far_from_target();
        if (refused) config.quirks.refused_objects = {0x6076};
        Rig rig{config};
        auto& other = rig.network().add_port();
        if (refused) {
          rig.run(3s);
          enable_from_elsewhere(rig);
        } else {
          ASSERT_TRUE(rig.start());
          rig.run(50ms);
          rig.write_to_drive(0x1400, 1, 0x80000201, 4);
          rig.loop().request_stop(rig.id(0));
        }
        while (!rig.status(0).feedback.stop_not_obeyed && rig.now() < hal::Time{20s}) rig.step();
        while (rig.status(0).feedback.stop_not_obeyed && rig.now() < hal::Time{20s}) rig.step();
        rig.run(after);
        if (enabled) enable_from_elsewhere(rig);
        ASSERT_EQ(other.send({.id = 0, .size = 2, .data = {2, 1}}, rig.now() + 1ms), hal::SendResult::queued);
        rig.run(500ms);
        EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << refused << enabled << after / 1ms;
        EXPECT_TRUE(rig.loop().reset_fault(rig.id(0))) << refused << enabled << after / 1ms;
      }
}

// One frame a period is for the SDO of all of them.
TEST(ForeignForce, ManyAxesOfASlowLoopThatObeyBySdoAreNotReset) {
  RigConfig config = far_from_target();
  config.period = 10ms;
  config.axes = 8;
  config.fault_scope = firmware::FaultScope::all_axes;
  Rig rig{config};
  ASSERT_TRUE(rig.start());
  for (std::size_t i = 0; i < config.axes; ++i) {
    const auto node = static_cast<std::uint32_t>(i + 1);
    rig.write_to_drive(0x1400, 1, 0x80000200U + node, 4, i);
    rig.write_to_drive(0x1800, 1, 0xC0000180U + node, 4, i);
    rig.loop().request_stop(rig.id(i));
  }
  rig.run(5s);
  for (std::size_t i = 0; i < config.axes; ++i) {
    EXPECT_EQ(rig.loop().drive(rig.id(i)).reboots(), 0U) << i;
    EXPECT_TRUE(rig.status(i).stop_not_obeyed) << i;
    EXPECT_LT(std::abs(rig.force_N(i)), 0.1) << i;
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(i))) << i;
  }
}

TEST(ForeignForce, AStopAndAnEnableInOnePeriodAreNoFault) {
  for (const int periods_between : {0, 1, 2, 5}) {
    Rig rig{far_from_target()};
    ASSERT_TRUE(rig.start());
    rig.run(50ms);
    rig.loop().request_stop(rig.id(0));
    for (int i = 0; i < periods_between; ++i) rig.step();
    rig.loop().request_enable(rig.id(0));
    rig.run(500ms);
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << periods_between;
    EXPECT_TRUE(rig.status(0).running) << periods_between;
  }
}

TEST(ForeignForce, ADriveThatWasRefusedIsForcedToStopWhenSomebodyElseSwitchesItOn) {
  RigConfig config;
  config.quirks.refused_objects = {0x6076};
  Rig rig{config};
  const auto& drive = rig.loop().drive(rig.id(0));
  rig.run(3s);
  ASSERT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
  ASSERT_EQ(drive.setup_object().index, 0x6076);
  const canopen::SdoAbort why = drive.setup_abort_code();
  for (int again = 0; again < 3; ++again) {
    enable_from_elsewhere(rig);
    rig.run(5ms);
    ASSERT_GT(std::abs(rig.force_N(0)), 5);
    EXPECT_LE(rig.largest_force_N(0, 10ms), 50);
    rig.run(60ms);
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
    EXPECT_TRUE(rig.status(0).stop_not_obeyed);
    rig.run(3s);
    EXPECT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
    EXPECT_EQ(drive.setup_object().index, 0x6076) << "what it was refused for is still to be seen";
    EXPECT_EQ(drive.setup_abort_code(), why);
  }
}

TEST(ForeignForce, ADriveThatWasRefusedMovesNothingBeforeAResetThoughItWouldDoNow) {
  Rig rig{{}};
  rig.loop().request_enable(rig.id(0));
  while (rig.status(0).fault == AxisFault::none && rig.now() < hal::Time{3s}) {
    rig.write_to_drive(0x607E, 0, 0x80, 1);  // as soon as it listens
    rig.step();
  }
  ASSERT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
  rig.drive(0).power_off(rig.now());
  rig.drive(0).power_on(rig.now());
  rig.run(5s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::drive_unusable);
  EXPECT_FALSE(rig.status(0).running);
  ASSERT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.run(2s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_TRUE(rig.status(0).running);
}

TEST(ForeignForce, AHomingThatIsTakenOutOfOperationalHasFailedAndIsNotBegunAgain) {
  RigConfig config;
  config.absolute_encoder = false;
  config.homing = {.home = cia402::Home::by_drive, .method = 37};
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  auto& tool = rig.network().add_port();
  int energised = 0;
  bool was = false;
  for (int told = 0; rig.now() < hal::Time{20s};) {
    rig.step();
    const bool is = rig.drive(0).state() == cia402::State::operation_enabled;
    energised += is && !was ? 1 : 0;
    was = is;
    if (!is || rig.status(0).feedback.state != hal::DriveState::homing || ++told % 10 != 0) continue;
    ASSERT_EQ(tool.send(canopen::nmt_frame(canopen::NmtCommand::enter_pre_operational, 1), rig.now() + 10ms),
              hal::SendResult::queued);
    ASSERT_EQ(tool.send({.id = 0x701, .size = 1, .data = {0x7F}}, rig.now() + 10ms), hal::SendResult::queued);
  }
  EXPECT_EQ(energised, 1);
  EXPECT_NE(rig.status(0).fault, AxisFault::none);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
}

}  // namespace
}  // namespace breakaway::closed_loop
