// An axis behind an ODrive that goes wrong: every fault of the protocol is named, and the force stays bounded for any
// bits.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "odrive_rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;
using odrive::Estimates;

TEST(OdriveAxis, IsWithoutForceWithinThreePeriodsOfAStop) {
  OdriveRig rig{with(Estimates::polled)};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.loop().request_stop(rig.id());
  rig.run(3ms);
  EXPECT_EQ(rig.drive().state(), odrive::AxisState::idle);
  EXPECT_LT(std::abs(rig.force_N()), 1e-3);
  rig.run(200ms);
  EXPECT_EQ(rig.status().feedback.state, hal::DriveState::disabled);
  EXPECT_EQ(rig.status().fault, AxisFault::none);
}

struct NamedFault {
  std::string name;
  void (*happen)(OdriveRig&);
  AxisFault fault;
  std::string text;  // in the name of its code
  hal::Duration within;
};

void trip(OdriveRig& rig, std::uint32_t errors) { rig.drive().trip(errors, rig.now()); }

std::vector<NamedFault> named_faults() {
  return {
      {"supply too high", [](OdriveRig& r) { trip(r, 1U << 8U); }, AxisFault::emergency, "voltage of the supply",
       103ms},
      {"motor too hot", [](OdriveRig& r) { trip(r, 1U << 13U); }, AxisFault::emergency, "motor is too hot", 103ms},
      {"emergency stop",
       [](OdriveRig& r) {
         auto& other = r.network().add_port();
         static_cast<void>(other.send(odrive::estop_frame(1), r.now() + 1s));
       },
       AxisFault::emergency, "emergency stop", 104ms},
      {"disarmed without a word", [](OdriveRig& r) { r.drive().disarm_silently(r.now()); },
       AxisFault::drive_left_enabled, "no error", 110ms},
      {"position not a number", [](OdriveRig& r) { r.drive().show_position(NAN); }, AxisFault::emergency,
       "position that is not a number", 4ms},
      {"position infinite", [](OdriveRig& r) { r.drive().show_position(-HUGE_VALF); }, AxisFault::emergency,
       "position that is not a number", 4ms},
      {"position too far", [](OdriveRig& r) { r.drive().show_position(1e6F); }, AxisFault::emergency, "coarser", 4ms},
      {"position jumps", [](OdriveRig& r) { r.drive().show_position(60.0F); }, AxisFault::position_limit, "", 4ms},
      {"torque not a number", [](OdriveRig& r) { r.drive().show_torque(NAN); }, AxisFault::emergency,
       "torque that is not a number", 4ms},
      {"torque beyond its limit", [](OdriveRig& r) { r.drive().show_torque(3.0F); }, AxisFault::force_limit, "", 4ms},
      {"torque reversed", [](OdriveRig& r) { r.drive().show_torque(-1.0F); }, AxisFault::force_not_commanded, "", 60ms},
      {"estimates end", [](OdriveRig& r) { r.drive().suppress_estimates(true); }, AxisFault::feedback_stale, "", 5ms},
      {"reports of torque end", [](OdriveRig& r) { r.drive().suppress_torques(true); }, AxisFault::emergency,
       "torques_msg_rate_ms", 13ms},
      {"heartbeats end", [](OdriveRig& r) { r.drive().suppress_heartbeat(true); }, AxisFault::heartbeat_lost, "",
       253ms},
      {"bus unplugged", [](OdriveRig& r) { r.drive().set_silent(true); }, AxisFault::feedback_stale, "", 5ms},
      {"power lost", [](OdriveRig& r) { r.drive().power_off(r.now()); }, AxisFault::feedback_stale, "", 5ms},
      {"another commands it",
       [](OdriveRig& r) {
         auto& other = r.network().add_port();
         static_cast<void>(other.send(odrive::torque_frame(1, 0.5F), r.now() + 1s));
       },
       AxisFault::another_master, "", 3ms},
      {"reboot by another",
       [](OdriveRig& r) {
         auto& other = r.network().add_port();
         static_cast<void>(other.send({.id = odrive::identifier(1, odrive::Command::reboot), .size = 1}, r.now() + 1s));
       },
       AxisFault::another_master, "", 3ms},
  };
}

TEST(OdriveAxis, NamesEveryFaultOfTheProtocolAndTakesTheForceOff) {
  for (const Estimates estimates : {Estimates::cyclic, Estimates::polled}) {
    for (const NamedFault& row : named_faults()) {
      OdriveRigConfig config = with(estimates);
      config.start_m = -1;
      config.limits.position_min_m = -2, config.limits.position_max_m = 2;
      config.absolute_encoder = true;
      OdriveRig rig{config};
      ASSERT_TRUE(rig.start()) << row.name;
      rig.run(30ms);
      row.happen(rig);
      const hal::Duration took = rig.time_until_fault(2s);
      EXPECT_EQ(rig.status().fault, row.fault) << row.name << ": " << to_string(rig.status().fault);
      EXPECT_NE(text_of(rig).find(row.text), std::string::npos) << row.name << ": " << text_of(rig);
      EXPECT_LE(took, row.within) << row.name;
      rig.run(80ms);  // its watchdog takes 50
      EXPECT_LT(std::abs(rig.force_N()), 1e-3) << row.name;
      EXPECT_NE(rig.drive().state(), odrive::AxisState::closed_loop_control) << row.name;
      EXPECT_LE(rig.largest_force_N(), 50 * (1 + 1e-6)) << row.name;
    }
  }
}

TEST(OdriveAxis, IsForcedToAStopByEstopWhereIdleIsIgnored) {
  OdriveRigConfig config = with(Estimates::cyclic);
  config.drive.ignores_idle = true;
  OdriveRig rig{config};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.loop().request_stop(rig.id());
  rig.run(110ms);
  EXPECT_EQ(rig.drive().state(), odrive::AxisState::closed_loop_control);
  EXPECT_LT(std::abs(rig.force_N()), 1e-3) << "the torque is 0 all the same";
  rig.run(60ms);
  EXPECT_EQ(rig.drive().state(), odrive::AxisState::idle);
  EXPECT_EQ(rig.status().fault, AxisFault::stop_not_obeyed);
}

TEST(OdriveAxis, ThatObeysNoStopAtAllIsNamedAndGivesNoForce) {
  OdriveRigConfig config = with(Estimates::polled);
  config.drive.ignores_idle = config.drive.ignores_estop = true;
  OdriveRig rig{config};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.loop().request_stop(rig.id());
  rig.run(1s);
  EXPECT_EQ(rig.status().fault, AxisFault::stop_not_obeyed);
  EXPECT_FALSE(rig.loop().reset_fault(rig.id()));
  EXPECT_LT(std::abs(rig.force_N()), 1e-3);
}

TEST(OdriveAxis, IsDisarmedByItsOwnWatchdogWhenTheLoopDies) {
  OdriveRig rig{with(Estimates::cyclic)};
  ASSERT_TRUE(rig.start());
  rig.run(10ms);
  EXPECT_GT(std::abs(rig.force_N()), 1);
  rig.network().advance_to(rig.now() + 60ms);
  EXPECT_EQ(rig.drive().errors(), odrive::error::watchdog_timer_expired);
  EXPECT_EQ(rig.drive().state(), odrive::AxisState::idle);
}

TEST(OdriveAxis, RunsOnAfterAFaultWasReset) {
  OdriveRig rig{with(Estimates::polled)};
  ASSERT_TRUE(rig.start());
  rig.run(50ms);
  trip(rig, 1U << 9U);
  rig.time_until_fault(1s);
  EXPECT_EQ(rig.status().fault, AxisFault::emergency);
  rig.run(200ms);
  ASSERT_TRUE(rig.loop().reset_fault(rig.id()));
  rig.run(10s);
  EXPECT_EQ(rig.status().fault, AxisFault::none) << to_string(rig.status().fault) << text_of(rig);
  EXPECT_TRUE(rig.status().running);
  EXPECT_LE(std::abs(rig.position_m()), static_cast<double>(Rig::parameters_for(1ms).position_tolerance_m) + 0.5e-6);
}

TEST(OdriveAxis, ThatIsNotCalibratedSaysSo) {
  OdriveRigConfig config = with(Estimates::cyclic);
  config.drive.calibrated = false;
  OdriveRig rig{config};
  rig.loop().request_enable(rig.id());
  rig.run(3s);
  EXPECT_EQ(rig.status().fault, AxisFault::drive_fault);
  EXPECT_NE(text_of(rig).find("not calibrated"), std::string::npos) << text_of(rig);
}

TEST(OdriveAxis, WithAnIncrementalEncoderLosesItsReferenceInAReboot) {
  OdriveRigConfig config = with(Estimates::cyclic);
  config.absolute_encoder = false;
  OdriveRig rig{config};
  ASSERT_TRUE(rig.start());
  rig.run(100ms);
  rig.drive().power_on(rig.now());
  rig.run(1s);
  ASSERT_TRUE(rig.loop().reset_fault(rig.id()));
  rig.run(1s);
  EXPECT_EQ(rig.status().fault, AxisFault::reference_lost) << to_string(rig.status().fault);
  EXPECT_FALSE(rig.status().running);
}

TEST(OdriveAxis, BesideADriveOfTheSameNodeIdIsStopped) {
  OdriveRig rig{with(Estimates::cyclic)};
  sil::BrakedSlide elsewhere{motion::Slide{1, {{2.5, 4.5}, model::shape::constant(1)}, {0, 0.05, 0}}};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.network().add_drive(odrive_emulator::EmulatorConfig{.travel_per_turn_m = OdriveRig::travel_per_turn_m},
                          elsewhere);
  rig.time_until_fault(1s);
  EXPECT_TRUE(rig.status().fault == AxisFault::node_id_conflict || rig.status().fault == AxisFault::speed_limit)
      << to_string(rig.status().fault);
  rig.run(200ms);
  EXPECT_LT(std::abs(rig.force_N()), 1e-3);
}

// Another node sends whatever bits it likes under the drive's identifiers.
TEST(OdriveAxis, KeepsItsForceBoundedUnderRandomBitsInEveryMessage) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random{seed};
    const auto below = [&](unsigned n) { return static_cast<unsigned>(random()) % n; };
    OdriveRigConfig config = with(seed % 2 == 0 ? Estimates::polled : Estimates::cyclic);
    config.max_force_N = 30;
    OdriveRig rig{config};
    ASSERT_TRUE(rig.start());
    auto& other = rig.network().add_port();
    int ran = 0;
    for (int i = 0; i < 10000; ++i) {
      if (below(150) == 0) {
        // What the drive itself sends, so that it does not obey what the axis must survive.
        constexpr unsigned answers[] = {0x00, 0x01, 0x03, 0x09, 0x1C};
        hal::CanFrame frame{.id = static_cast<std::uint16_t>(1U << 5U | answers[below(5)]), .size = 8};
        for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(below(256));
        static_cast<void>(other.send(frame, rig.now() + 1ms));
      }
      if (below(60) == 0) static_cast<void>(rig.loop().reset_fault(rig.id()));
      rig.step();
      ran += rig.status().running;
      ASSERT_LE(std::abs(rig.force_N()), 30 * (1 + 1e-6)) << seed;
      if (!rig.status().running) {
        ASSERT_EQ(rig.status().output.force_N, 0) << seed;
      }
    }
    EXPECT_GT(ran, 500) << seed;
    rig.loop().request_stop(rig.id());
    rig.run(1s);
    EXPECT_LT(std::abs(rig.force_N()), 1e-3) << seed;
  }
}

// Whatever goes wrong in whatever order, the force stays inside its limit, is off within the time of the drive's
// watchdog when the loop does not run the axis, and the axis comes back when all is well again.
class Misfortune {
 public:
  Misfortune(OdriveRig& rig, std::uint32_t seed) : rig_{rig}, random_{seed} {}

  void strike() {
    odrive_emulator::OdriveEmulator& drive = rig_.drive();
    switch (below(13)) {
      case 0:
        return drive.trip(1U << below(31), rig_.now());
      case 1:
        return drive.disarm_silently(rig_.now());
      case 2:
        return drive.set_silent(below(4) == 0);
      case 3:
        return drive.suppress_heartbeat(below(4) == 0);
      case 4:
        return drive.suppress_estimates(below(4) == 0);
      case 5:
        return drive.ignore_idle(below(4) == 0);
      case 6:
        return drive.ignore_estop(below(4) == 0);
      case 7:
        return drive.power_on(rig_.now());
      case 8:
        return drive.show_position(anything());
      case 9:
        return drive.show_torque(anything());
      case 10:
        return rig_.loop().request_stop(rig_.id());
      default:
        static_cast<void>(rig_.loop().reset_fault(rig_.id()));
        static_cast<void>(rig_.loop().set_reference_counts(rig_.id(), 0));
        return rig_.loop().request_enable(rig_.id());
    }
  }
  void end() {
    odrive_emulator::OdriveEmulator& drive = rig_.drive();
    drive.set_silent(false), drive.suppress_heartbeat(false), drive.suppress_estimates(false);
    drive.ignore_idle(false), drive.ignore_estop(false);
    drive.show_position({}), drive.show_torque({});
  }
  unsigned below(unsigned n) { return static_cast<unsigned>(random_()) % n; }

 private:
  std::optional<float> anything() {
    if (below(4) != 0) return {};
    return std::bit_cast<float>(static_cast<std::uint32_t>(random_()));
  }

  OdriveRig& rig_;
  std::mt19937 random_;
};

TEST(OdriveAxis, SurvivesRandomFaultsOnABusThatLosesFrames) {
  int ran = 0, settled = 0;
  for (std::uint32_t seed = 1; seed <= 70; ++seed) {
    OdriveRigConfig config = with(seed % 2 == 0 ? Estimates::polled : Estimates::cyclic);
    // Where one in fifty is lost, so are three samples in a row before an axis rests, and it is stopped; where one in
    // 500 is, hardly ever.
    config.bus.loss_probability = seed > 60 ? 0.002 : seed % 3 == 0 ? 0.02 : 0;
    config.bus.seed = seed;
    OdriveRig rig{config};
    rig.loop().request_enable(rig.id());
    Misfortune misfortune{rig, seed};
    int not_running = 0;
    for (int i = 0; i < 6000; ++i) {
      if (misfortune.below(120) == 0) misfortune.strike();
      rig.step();
      ran += rig.status().running;
      not_running = rig.status().running ? 0 : not_running + 1;
      ASSERT_LE(std::abs(rig.force_N()), 50 * (1 + 1e-6)) << seed << " at " << i;
      if (not_running > 60) {
        ASSERT_LT(std::abs(rig.force_N()), 1e-3) << seed << " at " << i;
      }
    }
    misfortune.end();
    rig.loop().request_stop(rig.id());
    rig.run(1s);
    EXPECT_TRUE(odrive::is_without_torque(rig.drive().state())) << seed;
    EXPECT_NE(rig.status().feedback.state, hal::DriveState::stopping) << seed;
    // What a drive that is being set up will show has no name yet, and is acknowledged when it has.
    for (int resets = 0; resets < 2; ++resets) {
      EXPECT_TRUE(rig.loop().reset_fault(rig.id())) << seed;
      rig.run(1s);
    }
    EXPECT_TRUE(rig.loop().set_reference_counts(rig.id(), -1000)) << seed;
    rig.loop().request_enable(rig.id());
    rig.run(6s);
    if (config.bus.loss_probability == 0) {
      EXPECT_EQ(rig.status().fault, AxisFault::none) << seed << ": " << to_string(rig.status().fault) << text_of(rig);
      EXPECT_TRUE(rig.status().running) << seed;
    }
    settled += rig.status().running && rig.at_rest();
  }
  EXPECT_GT(ran, 20000);
  EXPECT_GT(settled, 40) << "more than all on buses that lose nothing";
}

}  // namespace
}  // namespace breakaway::closed_loop
