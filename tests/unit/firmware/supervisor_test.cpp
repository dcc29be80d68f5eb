#include "breakaway/firmware/supervisor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>

namespace breakaway::firmware {
namespace {

using namespace std::chrono_literals;
using Feedback = hal::DriveFeedback<float>;

AxisLimits<float> limits() {
  AxisLimits<float> l;
  l.position_min_m = -1;
  l.position_max_m = 1;
  l.speed_m_s = 2;
  l.force_N = 50;
  l.following_error_m = 0.1F;
  l.feedback_timeout = 2500us;
  return l;
}

Feedback healthy(hal::Time now) {
  Feedback f;
  f.state = hal::DriveState::enabled;
  f.sample_time = now;
  f.fresh = f.ever_valid = true;
  return f;
}

struct Violation {
  const char* label;
  AxisFault expected;
  std::function<void(Feedback&, AxisHealth&)> inject;
};

class SupervisorNames : public ::testing::TestWithParam<Violation> {};

TEST_P(SupervisorNames, AndLatchesTheFault) {
  Supervisor<float> supervisor{limits()};
  supervisor.begin_motion(0.0F);
  const AxisHealth well;
  for (const hal::Time now : {hal::Time{1ms}, hal::Time{2ms}})
    ASSERT_EQ(supervisor.check(healthy(now), well, now), AxisFault::none);
  Feedback bad = healthy(hal::Time{3ms});
  AxisHealth ill;
  GetParam().inject(bad, ill);
  EXPECT_EQ(supervisor.check(bad, ill, hal::Time{3ms}), GetParam().expected);
  EXPECT_EQ(supervisor.check(healthy(hal::Time{4ms}), well, hal::Time{4ms}), GetParam().expected) << "latched";
  EXPECT_EQ(supervisor.fault_time(), hal::Time{3ms});
  supervisor.reset();
  EXPECT_EQ(supervisor.check(healthy(hal::Time{5ms}), well, hal::Time{5ms}), AxisFault::none);
}

constexpr float infinity = std::numeric_limits<float>::infinity();

INSTANTIATE_TEST_SUITE_P(
    Faults, SupervisorNames,
    ::testing::Values(
        Violation{"stale", AxisFault::feedback_stale,
                  [](Feedback& f, AxisHealth&) {
                    f.fresh = false;
                    f.sample_time = hal::Time{};
                  }},
        Violation{"heartbeat", AxisFault::heartbeat_lost, [](Feedback&, AxisHealth& h) { h.heartbeat_lost = true; }},
        Violation{"emcy", AxisFault::emergency, [](Feedback&, AxisHealth& h) { h.emergency_code = 0x2310; }},
        Violation{"fault", AxisFault::drive_fault, [](Feedback& f, AxisHealth&) { f.state = hal::DriveState::fault; }},
        Violation{"faulty", AxisFault::drive_fault,
                  [](Feedback& f, AxisHealth&) {
                    f.faulty = true;
                    f.state = hal::DriveState::stopping;  // the reaction to it is not over yet
                  }},
        Violation{"left", AxisFault::drive_left_enabled,
                  [](Feedback& f, AxisHealth&) { f.state = hal::DriveState::disabled; }},
        Violation{"rebooted", AxisFault::drive_left_enabled,
                  [](Feedback& f, AxisHealth&) { f.state = hal::DriveState::configuring; }},
        Violation{"position", AxisFault::position_limit,
                  [](Feedback& f, AxisHealth&) {
                    f.position_m = 1.001F;
                    f.sample_time = hal::Time{10s};
                  }},
        Violation{"speed", AxisFault::speed_limit, [](Feedback& f, AxisHealth&) { f.travel_m = 0.003F; }},
        Violation{"jump", AxisFault::speed_limit, [](Feedback& f, AxisHealth&) { f.travel_m = -0.9F; }},
        Violation{"force", AxisFault::force_limit, [](Feedback& f, AxisHealth&) { f.force_N = -50.1F; }},
        Violation{"following", AxisFault::following_error,
                  [](Feedback& f, AxisHealth&) { f.position_offset_m = 0.11F; }},
        Violation{"nan", AxisFault::not_a_number,
                  [](Feedback& f, AxisHealth&) { f.position_offset_m = std::nanf(""); }},
        Violation{"nan_travel", AxisFault::not_a_number, [](Feedback& f, AxisHealth&) { f.travel_m = std::nanf(""); }},
        Violation{"inf", AxisFault::not_a_number, [](Feedback& f, AxisHealth&) { f.force_N = infinity; }},
        Violation{"jammed", AxisFault::axis_jammed,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::jammed; }},
        Violation{"diverging", AxisFault::position_diverging,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::diverging; }},
        Violation{"hunting", AxisFault::axis_hunting,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::hunting; }},
        Violation{"drifting", AxisFault::axis_drifting,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::drifting; }},
        Violation{"contradicted", AxisFault::axis_not_as_told,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::contradicted; }},
        Violation{"spring_limit", AxisFault::axis_at_spring_limit,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::spring_limit; }},
        Violation{"below_floor", AxisFault::axis_below_floor,
                  [](Feedback&, AxisHealth& h) { h.control_fault = law::ControlFault::below_floor; }},
        Violation{"another_master", AxisFault::another_master,
                  [](Feedback&, AxisHealth& h) { h.another_master = true; }},
        Violation{"node_id_conflict", AxisFault::node_id_conflict,
                  [](Feedback&, AxisHealth& h) { h.node_id_conflict = true; }},
        Violation{"reference_lost", AxisFault::reference_lost,
                  [](Feedback&, AxisHealth& h) { h.reference_lost = true; }},
        Violation{"below", AxisFault::position_limit, [](Feedback& f, AxisHealth&) { f.position_m = -1.01F; }},
        Violation{"above", AxisFault::position_limit, [](Feedback& f, AxisHealth&) { f.position_m = 1.01F; }},
        Violation{"pushed", AxisFault::force_limit, [](Feedback& f, AxisHealth&) { f.force_N = 50.1F; }},
        Violation{"pulled", AxisFault::force_limit, [](Feedback& f, AxisHealth&) { f.force_N = -50.1F; }},
        Violation{"bus", AxisFault::bus_off, [](Feedback&, AxisHealth& h) { h.bus_off = true; }}),
    [](const auto& param_info) { return std::string{param_info.param.label}; });

TEST(Supervisor, TakesInTheCodeOfItsFaultThatIsReadLaterAndNoOther) {
  Supervisor<float> supervisor{limits()};
  supervisor.latch(AxisFault::none, 0x1111, {});
  supervisor.latch(AxisFault::drive_fault, 0, hal::Time{1ms});
  supervisor.latch(AxisFault::emergency, 0x8110, hal::Time{2ms});
  EXPECT_EQ(supervisor.fault_code(), 0);
  supervisor.latch(AxisFault::drive_fault, 0x2310, hal::Time{3ms});
  EXPECT_EQ(supervisor.fault_code(), 0x2310);
  supervisor.latch(AxisFault::drive_fault, 0x7305, hal::Time{4ms});
  EXPECT_EQ(supervisor.fault_code(), 0x2310) << "the first one stays";
  EXPECT_EQ(supervisor.fault(), AxisFault::drive_fault);
  EXPECT_EQ(supervisor.fault_time(), hal::Time{1ms});
}

TEST(Supervisor, HasEveryFaultInTheListForItsUsers) {
  std::ifstream file{BREAKAWAY_SOURCE_DIR "/firmware/FAULTS.md"};
  std::ostringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  int faults = 0;
  for (int i = 1; !to_string(static_cast<AxisFault>(i)).starts_with("unknown"); ++i, ++faults) {
    const std::string row = "| " + std::string{to_string(static_cast<AxisFault>(i))} + " |";
    EXPECT_NE(page.find(row), page.npos) << row;
  }
  EXPECT_EQ(faults, static_cast<int>(AxisFault::external_motion));
}

TEST(Supervisor, NamesWhatKeepsAnIdleAxisFromTheBus) {
  struct Idle {
    AxisHealth health;
    AxisFault expected;
  };
  for (const auto& [health, expected] :
       {Idle{{}, AxisFault::none}, Idle{{.heartbeat_lost = true}, AxisFault::heartbeat_lost},
        Idle{{.bus_off = true}, AxisFault::bus_off}, Idle{{.another_master = true}, AxisFault::another_master},
        Idle{{.node_id_conflict = true}, AxisFault::node_id_conflict},
        Idle{{.heartbeat_lost = true, .reference_lost = true}, AxisFault::reference_lost}}) {
    Supervisor<float> supervisor{limits()};
    supervisor.check_idle(health, hal::Time{3ms});
    EXPECT_EQ(supervisor.fault(), expected) << to_string(supervisor.fault());
  }
}

TEST(Supervisor, LetsAnAxisBeyondALimitOfPositionComeBackButNotGoFurther) {
  for (const float sign : {1.0F, -1.0F}) {
    Supervisor<float> supervisor{{.position_min_m = -1, .position_max_m = 1}};
    supervisor.begin_commands(1.5F * sign);
    int i = 0;
    const auto at = [&](float position_m) {
      Feedback f = healthy(hal::Time{++i * 1ms});
      f.position_m = sign * position_m;
      return supervisor.check(f, {}, f.sample_time);
    };
    for (const float position_m : {1.5F, 1.4F, 1.2F, 1.2F}) EXPECT_EQ(at(position_m), AxisFault::none);
    EXPECT_EQ(at(1.21F), AxisFault::position_limit) << "out again";
    supervisor.reset();
    supervisor.begin_commands(1.2F * sign);
    for (const float position_m : {1.2F, 0.5F, 1.0F}) EXPECT_EQ(at(position_m), AxisFault::none);
    EXPECT_EQ(at(1.01F), AxisFault::position_limit) << "it was inside";
  }
}

TEST(Supervisor, NamesAnAxisThatComesNoNearerForAMinute) {
  for (const bool on_its_way : {true, false}) {
    Supervisor<float> supervisor{{}};
    supervisor.begin_motion(-2);
    hal::Time now{};
    const auto stand_for = [&](hal::Duration duration, float error_m) {
      for (const hal::Time end = now + duration; now < end;) {
        now += 100ms;
        Feedback f = healthy(now);
        f.position_offset_m = error_m;
        supervisor.check(f, {.on_its_way = on_its_way}, now);
      }
      return supervisor.fault();
    };
    EXPECT_EQ(stand_for(59s, -1), AxisFault::none);
    EXPECT_EQ(stand_for(59s, -0.9F), AxisFault::none) << "it came nearer";
    EXPECT_EQ(stand_for(2s, 0.95F), on_its_way ? AxisFault::target_not_reached : AxisFault::none);
    supervisor.reset();
    supervisor.begin_motion(-2);
    EXPECT_EQ(stand_for(59s, -1.9F), AxisFault::none) << "another target";
  }
}

TEST(Supervisor, ToleratesOneLostSample) {
  Supervisor<float> supervisor{limits()};
  ASSERT_EQ(supervisor.check(healthy(hal::Time{1ms}), {}, hal::Time{1ms}), AxisFault::none);
  Feedback old = healthy(hal::Time{1ms});
  old.fresh = false;
  EXPECT_EQ(supervisor.check(old, {}, hal::Time{3ms}), AxisFault::none);
  EXPECT_EQ(supervisor.check(old, {}, hal::Time{4ms}), AxisFault::feedback_stale);
}

// Read from the drive's zero, the position jumps by the whole range there.
TEST(Supervisor, TakesTheEndOfTheCountersRangeForNoSpeed) {
  AxisLimits<float> l;
  l.speed_m_s = 2;
  l.feedback_timeout = 2500us;
  Supervisor<float> supervisor{l};
  for (int i = 1; i < 10; ++i) {
    Feedback f = healthy(hal::Time{i * 1ms});
    f.position_m = i < 5 ? 2147.4836F : -2147.4836F;
    f.travel_m = 0.0015F;
    ASSERT_EQ(supervisor.check(f, {}, f.sample_time), AxisFault::none);
  }
}

TEST(Supervisor, KeepsTheFirstOfSeveralFaults) {
  Supervisor<float> supervisor{limits()};
  AxisHealth ill;
  ill.emergency_code = 0x7305;
  Feedback bad = healthy(hal::Time{1ms});
  bad.state = hal::DriveState::fault;
  bad.fault_code = 0x1000;
  EXPECT_EQ(supervisor.check(bad, ill, hal::Time{1ms}), AxisFault::emergency);
  EXPECT_EQ(supervisor.fault_code(), 0x7305);
  ill.bus_off = true;
  EXPECT_EQ(supervisor.check(bad, ill, hal::Time{2ms}), AxisFault::emergency);
}

TEST(Supervisor, AllowsTheErrorThatATargetChangeMakes) {
  Supervisor<float> supervisor{limits()};
  supervisor.begin_motion(-0.5F);
  Feedback f = healthy(hal::Time{1ms});
  f.position_offset_m = -0.59F;
  EXPECT_EQ(supervisor.check(f, {}, hal::Time{1ms}), AxisFault::none);
  f.position_offset_m = -0.61F;
  EXPECT_EQ(supervisor.check(f, {}, hal::Time{2ms}), AxisFault::following_error);
}

TEST(Supervisor, WatchesNothingThatHasNoLimit) {
  Supervisor<float> supervisor{{.feedback_timeout = 2500us}};
  supervisor.begin_motion(0);
  for (int i = 1; i < 100; ++i) {
    const hal::Time now{i * 1ms};
    Feedback f = healthy(now);
    f.position_m = f.position_offset_m = f.force_N = 1e30F * static_cast<float>(i % 2);
    EXPECT_EQ(supervisor.check(f, {}, now), AxisFault::none);
  }
}

}  // namespace
}  // namespace breakaway::firmware
