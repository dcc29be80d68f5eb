// The project's master against the emulated drive, frame by frame over the virtual bus. The two sides were written
// apart from the standards and share constants only.
#include <breakaway/canopen/heartbeat.hpp>
#include <breakaway/canopen/sync.hpp>
#include <breakaway/cia402/drive.hpp>
#include <breakaway/drive_emulator/drive_emulator.hpp>
#include <breakaway/virtual_bus/virtual_bus.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace {

using namespace std::chrono_literals;
using breakaway::cia402::Drive;
using breakaway::cia402::SetupStatus;
using breakaway::drive_emulator::DriveEmulator;
using breakaway::hal::CanFrame;
using breakaway::hal::DriveFeedback;
using breakaway::hal::DriveState;
using breakaway::hal::Duration;
using breakaway::hal::ReceivedFrame;
using breakaway::hal::SendResult;
using breakaway::hal::Time;
using breakaway::virtual_bus::VirtualBus;
using breakaway::virtual_bus::VirtualBusConfig;

constexpr std::uint8_t node_id = 5;
constexpr Duration period = 1ms;

// Holds the axis where the test puts it.
class HeldAxis final : public breakaway::drive_emulator::Mechanism {
 public:
  void advance_to(double, const breakaway::model::AppliedForce&) override {}
  double position_m() const override { return position; }
  double position = 0;
};

// 0.05 N a per mille, 50 N at most, 1 um a count.
breakaway::drive_emulator::EmulatorConfig emulated_drive() {
  breakaway::drive_emulator::EmulatorConfig config;
  config.node_id = node_id;
  config.force_per_torque_N_per_Nm = 50;
  config.max_torque_per_mille = 1000;
  return config;
}

class Bench {
 public:
  explicit Bench(const breakaway::drive_emulator::EmulatorConfig& config = emulated_drive(),
                 const VirtualBusConfig& bus_config = {})
      : bus{bus_config},
        master{bus.add_port()},
        slave{bus.add_port()},
        emulator{
            config, axis,
            [this](const CanFrame& frame, Time) { EXPECT_EQ(slave.send(frame, Time::max()), SendResult::queued); }},
        drive{{.node_id = node_id, .force_per_torque_N_per_Nm = 50}, {.period = period}, {1e-6F, 50}} {
    slave.set_listener(
        [](void* self, const ReceivedFrame& received) noexcept {
          static_cast<Bench*>(self)->emulator.on_frame(received.frame, received.time);
        },
        this);
    emulator.power_on(Time{});
  }

  HeldAxis axis;
  VirtualBus bus;
  VirtualBus::Port& master;
  VirtualBus::Port& slave;
  DriveEmulator emulator;
  Drive<float> drive;
  breakaway::canopen::HeartbeatProducer heartbeat{127, 50ms};
  DriveFeedback<float> feedback{};
  bool master_silent = false;

  void step(float force_N = 0) {
    now_ += period;
    while (bus.now() < now_) {
      const Time next = std::min({now_, bus.next_event(), emulator.next_event().value_or(now_)});
      bus.advance_to(std::max(next, bus.now()));
      emulator.advance_to(bus.now());
    }
    if (master_silent) return;
    for (ReceivedFrame received; master.receive(received);) drive.on_frame(received);
    drive.update(now_);
    feedback = drive.feedback();
    drive.command(force_N);
    CanFrame frame;
    if (drive.next_command_frame(frame)) send(frame);
    send(breakaway::canopen::sync_frame());
    drive.on_sync(now_);
    if (heartbeat.next_frame(frame, breakaway::canopen::NmtState::operational, now_) ||
        drive.next_acyclic_frame(frame, now_))
      send(frame);
  }
  void run_for(Duration duration, float force_N = 0) {
    for (const Time end = now_ + duration; now_ < end;) step(force_N);
  }
  // False when the state is not reached in time.
  bool reach(DriveState state, Duration limit = 10s) {
    for (const Time end = now_ + limit; feedback.state != state;) {
      if (now_ >= end) return false;
      step();
    }
    return true;
  }
  bool enable() {
    if (!reach(DriveState::disabled)) return false;
    drive.request_enable();
    return reach(DriveState::enabled);
  }
  Time now() const { return now_; }

 private:
  void send(const CanFrame& frame) { EXPECT_EQ(master.send(frame, now_ + period), SendResult::queued); }

  Time now_{};
};

TEST(DriveInterop, IsSetUpAndEnabledOverTheBus) {
  Bench bench;
  ASSERT_TRUE(bench.reach(DriveState::disabled));
  EXPECT_LT(bench.now(), Time{500ms});
  EXPECT_EQ(bench.drive.setup_status(), SetupStatus::ready);
  EXPECT_FLOAT_EQ(bench.drive.torque_quantum_N(), 0.05F);
  bench.drive.request_enable();
  ASSERT_TRUE(bench.reach(DriveState::enabled));
  EXPECT_EQ(bench.emulator.state(), breakaway::cia402::State::operation_enabled);
  EXPECT_EQ(bench.bus.counters().stale, 0U);
  EXPECT_EQ(bench.bus.counters().overflows, 0U);
}

TEST(DriveInterop, ForceArrivesToTheQuantum) {
  Bench bench;
  ASSERT_TRUE(bench.enable());
  for (const float force_N : {10.0F, -37.52F, 0.024F, 0.026F, 50.0F, -1e6F}) {
    bench.run_for(5ms, force_N);
    const double expected = std::clamp(static_cast<double>(force_N), -50.0, 50.0);
    EXPECT_NEAR(bench.emulator.force().constant_N, expected, 0.025 + 1e-6) << force_N;
    EXPECT_NEAR(static_cast<double>(bench.feedback.force_N), bench.emulator.force().constant_N, 1e-5);
  }
  EXPECT_LE(bench.emulator.largest_force_N(bench.now()), 50.0 + 1e-9);
}

TEST(DriveInterop, PositionArrivesToTheCount) {
  Bench bench;
  ASSERT_TRUE(bench.enable());
  bench.drive.set_datum_counts(2'000'000);
  for (const double position : {2.0, 1.999'999, 2.000'123, -4.0}) {
    bench.axis.position = position;
    bench.run_for(3ms);
    EXPECT_TRUE(bench.feedback.fresh);
    EXPECT_NEAR(static_cast<double>(bench.feedback.position_offset_m), position - 2.0, 0.51e-6);
    EXPECT_EQ(bench.feedback.sample_time, bench.now() - period);
  }
}

struct Quirk {
  std::string label;
  breakaway::drive_emulator::EmulatorConfig config;
};
void PrintTo(const Quirk& quirk, std::ostream* out) { *out << quirk.label; }

std::vector<Quirk> quirks() {
  std::vector<Quirk> result;
  const auto add = [&result](std::string label, auto change) {
    breakaway::drive_emulator::EmulatorConfig config = emulated_drive();
    change(config);
    result.push_back({std::move(label), config});
  };
  add("ModeDisplayLags", [](auto& c) { c.quirks.mode_display_delay = 3s; });
  add("NeedsAModeToEnable", [](auto& c) { c.quirks.needs_mode_to_enable = true; });
  add("MissesFastControlwords", [](auto& c) { c.quirks.min_controlword_interval = 2500us; });
  add("InterpolationInMillisecondsOnly", [](auto& c) { c.quirks.interpolation_in_ms_only = true; });
  add("AlarmsWhenSyncIsLate", [](auto& c) { c.quirks.sync_alarm_periods = 2; });
  add("LateFeedback", [](auto& c) { c.max_tpdo_delay = 900us; });
  add("SlowServer", [](auto& c) { c.sdo_response_delay = 20ms; });
  add("SlowBoot", [](auto& c) { c.boot_duration = 1500ms; });
  add("AlreadyProducesHeartbeats", [](auto& c) { c.producer_heartbeat_ms = 20; });
  return result;
}

class DriveQuirks : public testing::TestWithParam<Quirk> {};

TEST_P(DriveQuirks, IsEnabledAndMakesForce) {
  Bench bench{GetParam().config};
  ASSERT_TRUE(bench.enable());
  bench.run_for(1s, 10.0F);
  EXPECT_EQ(bench.feedback.state, DriveState::enabled);
  EXPECT_NEAR(bench.emulator.force().constant_N, 10.0, 1e-6);
}
INSTANTIATE_TEST_SUITE_P(Quirks, DriveQuirks, testing::ValuesIn(quirks()),
                         [](const auto& row) { return row.param.label; });

TEST(DriveInterop, DriveWithoutCyclicTorqueIsRefusedByName) {
  auto config = emulated_drive();
  config.supported_modes = 0x1FF;
  Bench bench{config};
  ASSERT_TRUE(bench.reach(DriveState::unusable));
  EXPECT_EQ(bench.drive.setup_status(), SetupStatus::no_torque_mode);
  EXPECT_EQ(bench.drive.setup_object(), (breakaway::canopen::ObjectAddress{0x6502, 0}));
}

TEST(DriveInterop, FaultIsNamedLatchedAndReset) {
  Bench bench;
  ASSERT_TRUE(bench.enable());
  bench.emulator.trip_fault(0x2310, bench.bus.now());
  ASSERT_TRUE(bench.reach(DriveState::fault));
  EXPECT_EQ(bench.feedback.fault_code, 0x2310);
  bench.run_for(1s);
  EXPECT_EQ(bench.feedback.state, DriveState::fault);
  bench.drive.reset_fault();
  ASSERT_TRUE(bench.enable());
  EXPECT_EQ(bench.drive.last_emcy().code, 0);
}

TEST(DriveInterop, StopTakesTheForceAwayWithinTwoPeriods) {
  Bench bench;
  ASSERT_TRUE(bench.enable());
  bench.run_for(10ms, 20.0F);
  bench.drive.request_stop();
  bench.run_for(3 * period, 20.0F);
  EXPECT_EQ(bench.emulator.force().constant_N, 0.0);
  ASSERT_TRUE(bench.reach(DriveState::disabled));
  ASSERT_TRUE(bench.enable());
}

TEST(DriveInterop, SilentDropStaysOffUntilEnabledAgain) {
  auto config = emulated_drive();
  config.quirks.silent_drop_at = Time{1s};
  Bench bench{config};
  ASSERT_TRUE(bench.enable());
  ASSERT_LT(bench.now(), Time{1s});
  ASSERT_TRUE(bench.reach(DriveState::disabled, 2s));
  bench.run_for(500ms, 20.0F);
  EXPECT_EQ(bench.feedback.state, DriveState::disabled);
  ASSERT_TRUE(bench.enable());
}

TEST(DriveInterop, PowerCycleIsNoticedAndSetUpAnew) {
  Bench bench;
  ASSERT_TRUE(bench.enable());
  bench.emulator.power_off(bench.bus.now());
  bench.run_for(400ms);
  EXPECT_TRUE(bench.drive.heartbeat_lost());
  bench.emulator.power_on(bench.bus.now());
  ASSERT_TRUE(bench.reach(DriveState::configuring, 1s));
  EXPECT_EQ(bench.drive.reboots(), 1U);
  ASSERT_TRUE(bench.enable());
  EXPECT_FALSE(bench.drive.heartbeat_lost());
}

TEST(DriveInterop, DriveThatMissesTheMasterStopsAndComesBack) {
  Bench bench;
  ASSERT_TRUE(bench.enable());
  bench.run_for(10ms, 20.0F);
  bench.master_silent = true;
  bench.run_for(400ms);
  EXPECT_EQ(bench.emulator.force().constant_N, 0.0);
  bench.master_silent = false;
  bench.run_for(1s);
  EXPECT_NE(bench.feedback.state, DriveState::enabled);
  EXPECT_EQ(bench.drive.last_emcy().code, 0x8130);
  bench.drive.reset_fault();
  ASSERT_TRUE(bench.enable());
}

TEST(DriveInterop, LostFramesDelayTheSetUpButDoNotSpoilIt) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Bench bench{emulated_drive(), {.loss_probability = 0.02, .seed = seed}};
    ASSERT_TRUE(bench.reach(DriveState::disabled, 60s)) << "seed " << seed;
    for (int attempt = 0; attempt < 50 && bench.feedback.state != DriveState::enabled; ++attempt) {
      // Three commands lost in a row are a fault of the drive, and no fault of the set-up.
      if (bench.feedback.state == DriveState::fault) bench.drive.reset_fault();
      bench.drive.request_enable();
      bench.run_for(100ms);
    }
    EXPECT_EQ(bench.feedback.state, DriveState::enabled)
        << "seed " << seed << " error code " << std::hex << bench.feedback.fault_code;
  }
}

TEST(DriveInterop, TheWholeRateOfTheBusIsUsable) {
  for (const std::uint32_t bit_rate : {500'000U, 1'000'000U}) {
    Bench bench{emulated_drive(), {.bit_rate = bit_rate}};
    ASSERT_TRUE(bench.enable());
    bench.run_for(1s, 1.0F);
    EXPECT_EQ(bench.feedback.state, DriveState::enabled);
    EXPECT_EQ(bench.bus.counters().stale, 0U);
  }
}

}  // namespace
