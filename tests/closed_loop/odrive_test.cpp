// An axis behind an ODrive settles as behind CiA 402, and its loop is as fast as the bus allows.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/odrive/bus_budget.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_scenario.hpp"
#include "odrive_rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;
using odrive::Estimates;

struct Setting {
  std::string name;
  OdriveRigConfig config;
};

std::vector<Setting> settings() {
  Setting late{"cyclic, and a bus that delays every frame by up to 100 us", with(Estimates::cyclic)};
  late.config.bus.max_delay = 100us;
  return {{"cyclic", with(Estimates::cyclic)},
          {"cyclic, by a slow clock", with(Estimates::cyclic, 1e-4)},
          {"cyclic, by a fast clock", with(Estimates::cyclic, -1e-4)},
          {"cyclic, by a clock that slips 50 times in 10 s", with(Estimates::cyclic, 5e-3)},
          {"polled", with(Estimates::polled)},
          late};
}

// The bound is that of the law, and what CiA 402 reaches on this axis.
TEST(OdriveAxis, SettlesAsAccuratelyAsBehindCia402) {
  Rig reference{{.axes = 1}};
  ASSERT_TRUE(reference.start());
  reference.run(10s);
  const double bound_m = static_cast<double>(Rig::parameters_for(1ms).position_tolerance_m) + 0.5e-6;
  ASSERT_LE(std::abs(reference.position_m(0)), bound_m);
  for (const Setting& setting : settings()) {
    for (const double start_m : {-0.1, 0.0707, 0.9}) {
      OdriveRigConfig config = setting.config;
      config.start_m = start_m;
      OdriveRig rig{config};
      ASSERT_TRUE(rig.start()) << setting.name << ": " << to_string(rig.loop().drive(rig.id()).setup_status());
      rig.run(10s);
      EXPECT_EQ(rig.status().fault, AxisFault::none)
          << setting.name << " from " << start_m << ": " << to_string(rig.status().fault) << ", " << text_of(rig);
      EXPECT_LE(std::abs(rig.position_m()), bound_m) << setting.name << " from " << start_m;
      EXPECT_TRUE(rig.at_rest());
      EXPECT_LE(rig.largest_force_N(), 50 * (1 + 1e-6));
    }
  }
}

// The two files are of one axis; its tolerance is that of the file.
TEST(OdriveAxis, OfAFileSettlesLikeThatOfCia402) {
  const std::string scenarios = std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/";
  const auto canopen = sil::run_scenario(scenario::read_scenario(scenarios + "can_axis.toml"), {}).axes.front();
  ASSERT_TRUE(canopen.settled);
  const auto polled = [&] {
    auto s = scenario::read_scenario(scenarios + "odrive_axis.toml");
    s.node.axes.front().drive->odrive->estimates = Estimates::polled;
    s.worlds.front().odrive->estimate_period = s.worlds.front().odrive->torque_period = {};
    return s;
  };
  for (const auto& s : {scenario::read_scenario(scenarios + "odrive_axis.toml"), polled()}) {
    const auto odrive = sil::run_scenario(s, {}).axes.front();
    EXPECT_TRUE(odrive.faults.empty()) << odrive.faults.front().name;
    EXPECT_TRUE(odrive.settled);
    EXPECT_LE(std::abs(odrive.final_error_m), 3e-6);
    EXPECT_LE(odrive.max_force_N, 50 * (1 + 1e-6));
    std::printf("settles in %.3f s to %.2f um; behind CiA 402 in %.3f s to %.2f um\n", odrive.settling_time_s,
                1e6 * odrive.final_error_m, canopen.settling_time_s, 1e6 * canopen.final_error_m);
  }
}

// What `breakaway design` promises of the file, from many places: a command acts and a sample is taken when its frame
// has come, which is a little earlier or later each time.
TEST(OdriveAxis, OfACertifiedFileKeepsItsPromise) {
  auto s = scenario::read_scenario(std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/polled_odrive.toml");
  const config::Axis& axis = s.node.axes.front();
  ASSERT_EQ(config::why_not_certified(s.node, axis), "");
  const double promised_m = config::judged_tolerance_m(s.node, axis);
  const design::DesignReport report = config::examine(s.node).front();
  std::mt19937 random{11};
  for (int i = 0; i < 60; ++i) {
    s.worlds.front().position_m = std::uniform_real_distribution{-0.5, 0.5}(random);
    s.worlds.front().velocity_m_s = 0;
    const auto run = sil::run_scenario(s, {}).axes.front();
    EXPECT_TRUE(run.settled && run.faults.empty()) << i;
    EXPECT_LE(std::abs(run.final_error_m), promised_m) << i;
    EXPECT_LE(run.excursions.value().beyond_m, report.braked->beyond_m) << i;
  }
}

bool keeps_up(hal::Duration period, double late_share) {
  OdriveRigConfig config = with(Estimates::polled);
  config.period = period;
  OdriveRig rig{config};
  if (!rig.start()) return false;
  unsigned samples = 0, late = 0;
  for (const hal::Time end = rig.now() + 2s; rig.now() < end; ++samples) {
    rig.step();
    if (!rig.status().running) return false;
    late += !rig.status().feedback.fresh;
  }
  const double tolerance_m = Rig::parameters_for(period).accuracy_floor_m() + 2e-6;  // and two encoder counts
  return std::abs(rig.position_m()) <= tolerance_m && late <= late_share * samples;
}

double shortest_period_us(double late_share) {
  auto period = 700us;
  while (keeps_up(period - 5us, late_share)) period -= 5us;
  return static_cast<double>(period.count());
}

// Against the rates that worst-case stuffing of its five messages allows, with a frame a period kept free for what is
// not cyclic, and with none.
TEST(OdriveLoopRate, ReachesWhatTheBusAllows) {
  const odrive::Sampling polled{.estimates = Estimates::polled};
  const double promised_Hz = odrive::bus_budget(1, 1ms, 1'000'000, polled).max_rate_Hz;
  const double full_Hz = odrive::bus_budget(1, 1ms, 1'000'000, polled, 0).max_rate_Hz;
  const double none_late_Hz = 1e6 / shortest_period_us(0), few_late_Hz = 1e6 / shortest_period_us(0.01);
  std::printf("polled: %4.0f Hz of %4.0f, with few late samples %4.0f of %4.0f\n", none_late_Hz, promised_Hz,
              few_late_Hz, full_Hz);
  EXPECT_GE(none_late_Hz, 0.95 * promised_Hz);
  EXPECT_GE(few_late_Hz, 0.95 * full_Hz);
  constexpr odrive::Sampling cyclic{};
  static_assert(odrive::bus_budget(1, 1ms, 1'000'000, cyclic).fits(), "cyclic estimates come once a millisecond");
  static_assert(odrive::bus_budget(2, 1ms, 1'000'000, cyclic).fits());
  static_assert(!odrive::bus_budget(3, 1ms, 1'000'000, cyclic).fits());
}

}  // namespace
}  // namespace breakaway::closed_loop
