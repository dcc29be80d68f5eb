// The loop against a drive and a port of the test's own, so that only the loop is under test.
#include "breakaway/firmware/control_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <deque>
#include <memory>
#include <new>
#include <vector>

#include "../explained_enum.hpp"

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;

struct FakePort {
  std::vector<hal::CanFrame> sent;
  std::deque<hal::ReceivedFrame> to_receive;
  hal::BusState state = hal::BusState::error_active;
  bool full = false;
  int purges = 0;

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time) noexcept {
    if (full) return hal::SendResult::queue_full;
    sent.push_back(frame);
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (to_receive.empty()) return false;
    received = to_receive.front();
    to_receive.pop_front();
    return true;
  }
  void purge_transmit_queue() noexcept { ++purges; }
  hal::BusState bus_state() const noexcept { return state; }
};

// What the test sees of a drive that the loop owns a copy of.
struct DriveProbe {
  hal::DriveFeedback<float> feedback;
  std::vector<float> commands;
  std::vector<hal::Time> syncs;
  std::int32_t datum = 0;
  int enables = 0, stops = 0, resets = 0, frames = 0;
  bool heartbeat_lost = false;
  canopen::Emcy emcy;
  std::uint32_t emcy_count = 0;
  bool wants_acyclic = false;
};

enum class FakeStatus : std::uint8_t { ready };
constexpr std::string_view to_string(FakeStatus) noexcept { return "the drive is ready"; }

struct FakeDrive {
  DriveProbe* probe;
  std::uint8_t id;

  hal::DriveFeedback<float> feedback() noexcept { return probe->feedback; }
  void command(float force_N) noexcept { probe->commands.push_back(force_N); }
  void set_datum_counts(std::int32_t counts) noexcept { probe->datum = counts; }
  void request_enable() noexcept { ++probe->enables; }
  void request_stop() noexcept { ++probe->stops; }
  void reset_fault() noexcept { ++probe->resets; }
  float max_force_N() const noexcept { return 50; }
  FakeStatus setup_status() const noexcept { return FakeStatus::ready; }
  void on_frame(const hal::ReceivedFrame&) noexcept { ++probe->frames; }
  void on_sync(hal::Time time) noexcept { probe->syncs.push_back(time); }
  void update(hal::Time) noexcept {}
  bool next_acyclic_frame(hal::CanFrame& frame, hal::Time) noexcept {
    frame.id = canopen::sdo_request_cob_id(id);
    return probe->wants_acyclic;
  }
  bool next_command_frame(hal::CanFrame& frame) noexcept {
    frame.id = canopen::rpdo_cob_id(1, id);
    return true;
  }
  std::uint8_t node_id() const noexcept { return id; }
  bool heartbeat_lost() const noexcept { return probe->heartbeat_lost; }
  const canopen::Emcy& last_emcy() const noexcept { return probe->emcy; }
  std::uint32_t emcy_count() const noexcept { return probe->emcy_count; }
};

struct ProportionalLaw {
  float shifted = 0, limit_N = 0;
  int resets = 0;
  law::ControlFault fault_ = law::ControlFault::none;
  law::ControlOutput<float> update(const law::Measurement<float>& z) noexcept {
    return {z.fresh ? -10 * z.position_error_m : 0.0F, 0, law::Mode::approach, false};
  }
  void shift_target(float shift_m) noexcept { shifted += shift_m; }
  void reset() noexcept { ++resets; }
  void limit_force(float force_N) noexcept { limit_N = force_N; }
  law::ControlFault fault() const noexcept { return fault_; }
  law::Mode mode() const noexcept { return law::Mode::approach; }
};

using Loop = ControlLoop<FakePort, FakeDrive, ProportionalLaw, float>;

class ControlLoopTest : public ::testing::Test {
 protected:
  FakePort port;
  DriveProbe probe;
  Loop loop{port, {.period = 1ms, .heartbeat_period = 0ms}};
  hal::Time now{};

  void SetUp() override {
    AxisLimits<float> limits;
    limits.feedback_timeout = 2500us;
    limits.speed_m_s = 1;
    ASSERT_EQ(loop.add_axis({&probe, 1}, {}, limits, 1e-6F), AddAxis::added);
  }
  void step() {
    now += 1ms;
    probe.feedback.sample_time = now - 1ms;
    port.sent.clear();
    loop.step(now);
  }
  void enable() {
    loop.request_enable(0);
    probe.feedback = {.state = hal::DriveState::enabled, .fresh = true, .ever_valid = true};
    step();
    ASSERT_TRUE(loop.status(0).running);
  }
};

TEST_F(ControlLoopTest, SendsCommandsBeforeTheSyncAtWhichTheyAct) {
  probe.wants_acyclic = true;
  step();
  ASSERT_EQ(port.sent.size(), 3U);
  EXPECT_EQ(port.sent[0].id, canopen::rpdo_cob_id(1, 1));
  EXPECT_EQ(port.sent[1].id, canopen::sync_cob_id);
  EXPECT_EQ(port.sent[2].id, canopen::sdo_request_cob_id(1));
  EXPECT_EQ(probe.syncs.back(), now);
}

TEST_F(ControlLoopTest, AnAxisThatStopsAsAskedHasNoFaultAndCanBeEnabledAgain) {
  enable();
  loop.request_stop(0);
  for (const auto state : {hal::DriveState::stopping, hal::DriveState::disabled}) {
    probe.feedback.state = state;
    probe.feedback.fresh = true;
    step();
    EXPECT_EQ(loop.status(0).fault, AxisFault::none);
    EXPECT_FALSE(loop.status(0).running);
  }
  enable();
}

TEST_F(ControlLoopTest, GivesForceOnlyToAnEnabledAxis) {
  for (const auto state : {hal::DriveState::configuring, hal::DriveState::disabled, hal::DriveState::enabling,
                           hal::DriveState::stopping, hal::DriveState::fault, hal::DriveState::unusable}) {
    probe.feedback.state = state;
    probe.feedback.fresh = probe.feedback.ever_valid = true;
    step();
  }
  EXPECT_TRUE(probe.commands.empty());
  loop.reset_fault(0);
  enable();
  probe.feedback.position_offset_m = 2e-4F;
  step();
  EXPECT_FLOAT_EQ(probe.commands.back(), -2e-3F);
}

TEST_F(ControlLoopTest, EnablesOnlyWhatIsWanted) {
  probe.feedback.state = hal::DriveState::disabled;
  step();
  EXPECT_EQ(probe.enables, 0);
  loop.request_enable(0);
  step();
  EXPECT_EQ(probe.enables, 1);
}

TEST_F(ControlLoopTest, StopsTheDriveInTheStepThatSeesTheFault) {
  enable();
  const auto commands = probe.commands.size();
  probe.heartbeat_lost = true;
  step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::heartbeat_lost);
  EXPECT_EQ(probe.stops, 1);
  EXPECT_EQ(probe.commands.size(), commands) << "no force without a command";
  probe.heartbeat_lost = false;
  for (int i = 0; i < 10; ++i) step();
  EXPECT_EQ(probe.commands.size(), commands) << "latched";
  EXPECT_FALSE(loop.status(0).running);
  loop.reset_fault(0);
  EXPECT_EQ(probe.resets, 1);
  step();
  EXPECT_TRUE(loop.status(0).running);
}

TEST_F(ControlLoopTest, PassesEmergenciesOnOnce) {
  enable();
  probe.emcy.code = 0x2310;
  probe.emcy_count = 1;
  step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::emergency);
  EXPECT_EQ(loop.supervisor(0).fault_code(), 0x2310);
  loop.reset_fault(0);
  step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::none) << "an old message is no new emergency";
}

TEST_F(ControlLoopTest, NamesADriveThatIsInFaultBeforeItEverRan) {
  probe.feedback.state = hal::DriveState::fault;
  probe.feedback.fault_code = 0x3210;
  step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::drive_fault);
  EXPECT_EQ(loop.supervisor(0).fault_code(), 0x3210);
  loop.reset_fault(0);
  for (int i = 0; i < 900; ++i) step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::none) << "a reset takes the drive some time";
  for (int i = 0; i < 200; ++i) step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::drive_fault) << "this one did not help";
}

TEST_F(ControlLoopTest, TellsTheLawWhatForceTheDriveHas) {
  enable();
  EXPECT_EQ(loop.controller(0).limit_N, 50);
}

TEST_F(ControlLoopTest, StopsOnBusOff) {
  enable();
  port.state = hal::BusState::bus_off;
  step();
  EXPECT_EQ(loop.status(0).fault, AxisFault::bus_off);
  EXPECT_GE(port.purges, 1);
}

TEST_F(ControlLoopTest, MovesDatumAndLawWithTheTarget) {
  loop.set_target_counts(0, 5000);
  EXPECT_EQ(probe.datum, 5000);
  EXPECT_FLOAT_EQ(loop.controller(0).shifted, 5e-3F);
  loop.set_target_m(0, -1e-3F);
  EXPECT_EQ(probe.datum, -1000);
  EXPECT_NEAR(loop.controller(0).shifted, -1e-3F, 1e-9);
  loop.set_target_m(0, 1e30F);
  EXPECT_GT(probe.datum, 2147480000) << "saturates";
}

TEST_F(ControlLoopTest, TellsTheLawWhenASampleIsMissing) {
  enable();
  probe.feedback.position_offset_m = 1e-4F;
  probe.feedback.fresh = false;
  step();
  EXPECT_EQ(probe.commands.back(), 0.0F);
}

TEST_F(ControlLoopTest, CountsFramesThatThePortRefused) {
  port.full = true;
  step();
  EXPECT_EQ(loop.refused_frames(), 2U);
}

TEST_F(ControlLoopTest, HandsADriveItsFramesWithinABound) {
  port.to_receive.push_back({{.id = canopen::tpdo_cob_id(1, 2)}, {}});
  step();
  EXPECT_EQ(probe.frames, 0) << "another node's";
  for (int i = 0; i < 300; ++i) port.to_receive.push_back({{.id = canopen::tpdo_cob_id(1, 1)}, {}});
  step();
  EXPECT_EQ(probe.frames, 256);
  step();
  EXPECT_EQ(probe.frames, 300);
}

TEST_F(ControlLoopTest, LetsTheAxesTakeTurnsWithAcyclicFrames) {
  std::vector<DriveProbe> others(3);
  for (std::size_t i = 0; i < others.size(); ++i) {
    others[i].wants_acyclic = true;
    ASSERT_EQ(loop.add_axis({&others[i], static_cast<std::uint8_t>(i + 2)}, {}, {}, 1e-6F), AddAxis::added);
  }
  std::vector<int> seen(5);
  for (int i = 0; i < 30; ++i) {
    step();
    ASSERT_EQ(port.sent.size(), 6U) << "4 commands, SYNC, and one acyclic frame";
    ++seen[canopen::node_id_of(port.sent.back().id)];
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 0, 10, 10, 10}));
}

TEST_F(ControlLoopTest, TakesNoMoreAxesThanItHasRoomFor) {
  for (int i = 1; i < 8; ++i) ASSERT_EQ(loop.add_axis({&probe, 1}, {}, {}, 1e-6F), AddAxis::added);
  EXPECT_EQ(loop.add_axis({&probe, 1}, {}, {}, 1e-6F), AddAxis::no_room);
}

TEST(AddAxis, SaysWhatIsWrongAndWhatToDo) {
  test::expect_sentences<AddAxis>({{AddAxis::added, {"added"}}, {AddAxis::no_room, {"no room", "raise MaxAxes"}}});
}

TEST_F(ControlLoopTest, RefusesAxesThatDoNotFitTheBus) {
  EXPECT_EQ(loop.check_configuration(), canopen::BusFit::fits);
  for (int i = 1; i < 8; ++i) ASSERT_EQ(loop.add_axis({&probe, 1}, {}, {}, 1e-6F), AddAxis::added);
  EXPECT_EQ(loop.check_configuration(), canopen::BusFit::overloaded);
}

TEST_F(ControlLoopTest, SendsItsOwnHeartbeatInPlaceOfAnAcyclicFrame) {
  Loop beating{port, {.period = 1ms, .node_id = 100, .heartbeat_period = 10ms}};
  probe.wants_acyclic = true;
  ASSERT_EQ(beating.add_axis({&probe, 1}, {}, {}, 1e-6F), AddAxis::added);
  int heartbeats = 0;
  for (int i = 1; i <= 100; ++i) {
    port.sent.clear();
    beating.step(hal::Time{i * 1ms});
    heartbeats += port.sent.back().id == canopen::heartbeat_cob_id(100);
  }
  EXPECT_EQ(heartbeats, 10);
}

}  // namespace
}  // namespace breakaway::firmware
