// The main job: a stuck axis reaches its target, for every friction inside the stated bounds.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "breakaway/sil/run_loop_scenario.hpp"
#include "breakaway/study/friction_study.hpp"
#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

const std::string scenarios = std::string{BREAKAWAY_SOURCE_DIR} + "/sim/scenarios/";

study::StudyOptions three_starts(int random_laws) {
  study::StudyOptions options;
  options.starts = {{-4, -4}, {-0.1, 0}, {-0.01, 0}};
  options.random_laws = random_laws;
  return options;
}

TEST(ImpulsiveAxis, ReachesTheTargetUnderEveryFrictionLawOfItsClass) {
  const auto axis = scenario::read_scenario(scenarios + "can_axis.toml");
  for (const auto& row : study::run_study(axis, three_starts(100))) {
    SCOPED_TRACE(row.start.position_m);
    ASSERT_EQ(row.runs.size(), 104U);
    for (const auto& run : row.runs) {
      EXPECT_TRUE(run.settled) << run.law;
      EXPECT_LE(std::abs(run.final_error_m), 3e-6) << run.law;
      EXPECT_LE(run.max_force_N, 50) << run.law;
      EXPECT_FALSE(run.limit_cycle) << run.law;
      EXPECT_TRUE(run.faults.empty()) << run.law;
    }
  }
}

TEST(BrakedAxis, ReachesTheTargetAndIsNeverKickedBeyondItByMoreThanHalfACount) {
  const auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
  // The law kicks on until it is within its own tolerance, which is less than the 3 um that are judged.
  const double inside_s[] = {1.16, 0.14, 0.065};
  const double count_m = axis.node.axes[0].drive->encoder_resolution_m;
  const double most_m = axis.node.axes[0].controller.position_tolerance_m + count_m / 2;
  const double worst_s[] = {1.16, 0.14, 0.07};
  const auto rows = study::run_study(axis, three_starts(100));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(rows[i].start.position_m);
    for (const auto& run : rows[i].runs) {
      EXPECT_TRUE(run.settled) << run.law;
      EXPECT_LE(std::abs(run.final_error_m), most_m) << run.law;
      EXPECT_LE(run.excursions.beyond_m, count_m / 2) << run.law;
      EXPECT_GE(run.excursions.overshoot_m, run.excursions.beyond_m) << "it was never kicked from the other side";
      EXPECT_LE(run.excursions.peak_speed_m_s, 5.1) << run.law;
      EXPECT_LE(run.kicks, 8U) << run.law;
      EXPECT_TRUE(run.faults.empty()) << run.law;
      EXPECT_GE(worst_time_inside_s(rows[i]), run.reached.back().time_s) << run.law;
    }
    EXPECT_LE(worst_settling_time_s(rows[i]), worst_s[i]);
    EXPECT_LE(worst_time_inside_s(rows[i]), inside_s[i]);
    EXPECT_LE(worst_time_inside_s(rows[i]), worst_settling_time_s(rows[i]));
  }
}

// Two thousand million counts from zero, where a float holds every 128th: a millimetre before the end of its range.
TEST(BrakedAxis, ReachesATargetBesideALimitFarFromTheEncodersZero) {
  const auto axis = scenario::parse_scenario(R"(
[plant]
mass_kg = 12
position_m = 18539.508
[friction]
lower_N = 15
upper_N = 16
[controller]
target_m = 18539.706879
k1_N_per_m = 4800
k21_Ns_per_m = 384
k22_Ns_per_m = 720
max_force_N = 100
max_approach_speed_m_s = 1.9
position_tolerance_m = 4.6e-6
[uncertainty]
mass = 0.02
force_gain = 0.02
current_loop_time_constant = 0.2
[loop]
period_s = 0.001
[drive]
rated_torque_Nm = 100
rated_current_A = 1
max_torque_per_mille = 1000
force_per_torque_N_per_Nm = 1
encoder_resolution_m = 9e-6
current_loop_time_constant_s = 0.0002
[limits]
position_min_m = 18538.708
position_max_m = 18539.708
speed_m_s = 3.8
[run]
duration_s = 2
settle_tolerance_m = 9.1e-6
settle_time_s = 0.2
)",
                                             "far.toml");
  ASSERT_TRUE(config::examine(axis.node).front().certified);
  study::StudyOptions options;
  options.starts = {{18539.508, 0}, {18538.72, 0}};
  options.random_laws = 10;
  for (const auto& row : study::run_study(axis, options)) {
    for (const auto& run : row.runs) {
      EXPECT_TRUE(run.settled) << run.law << " from " << row.start.position_m;
      EXPECT_TRUE(run.faults.empty()) << run.law << ": " << run.faults.front().name;
    }
  }
}

// A float of a position error tells a slow approach the less of its speed the further away it is.
TEST(BrakedAxis, GetsOnFromAsFarAwayAsItIsCertified) {
  for (const double speed_m_s : {0.05, 0.5}) {
    SCOPED_TRACE(speed_m_s);
    auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
    axis.worlds[0].position_m = axis.worlds[0].velocity_m_s = 0;
    axis.run->duration_s = 3;
    config::Axis& told = axis.node.axes[0];
    told.uncertainty.mass = told.uncertainty.force_gain = 0.02;
    told.controller.max_approach_speed_m_s = speed_m_s;
    told.controller.position_tolerance_m = 3e-6;
    axis.node.settle_tolerance_m = 1e-5;
    told.limits.position_min_m = -0.1, told.limits.position_max_m = 0.1;
    const double end_m = 0.4999 * std::min(config::examine(axis.node).front().braked->farthest_m, 2000.0);
    told.limits.position_min_m = -end_m, told.limits.position_max_m = end_m;
    told.controller.target_m = std::floor(0.99 * end_m);
    const auto report = config::examine(axis.node).front();
    ASSERT_TRUE(report.certified);
    study::StudyOptions options;
    options.starts = {{-0.99 * end_m, 0}};
    options.random_laws = 20;
    for (const auto& run : study::run_study(axis, options).front().runs) {
      EXPECT_TRUE(run.faults.empty()) << run.law << ": " << run.faults.front().name;
      EXPECT_LE(run.excursions.peak_speed_m_s, report.braked->approach_peak_m_s) << run.law;
      EXPECT_EQ(run.kicks, 0U) << run.law;
    }
  }
}

// With a tolerance at the floor, between one count and two, the last kicks show by no count.
TEST(BrakedAxis, NeedsAsFewKicksToItsFloor) {
  auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
  axis.node.axes[0].uncertainty = {};
  axis.node.axes[0].controller.position_tolerance_m = 1.63e-6;
  ASSERT_TRUE(config::examine(axis.node).front().certified);
  ASSERT_LT(1.63e-6, 1.01 * config::examine(axis.node).front().braked->floor_m) << "hardly more than its floor";
  const double inside_s[] = {1.16, 0.14, 0.065};
  const auto rows = study::run_study(axis, three_starts(100));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(rows[i].start.position_m);
    for (const auto& run : rows[i].runs) {
      EXPECT_TRUE(run.settled) << run.law;
      EXPECT_LE(std::abs(run.final_error_m), 1.63e-6 + 0.5e-6) << run.law;
      EXPECT_LE(run.kicks, 8U) << run.law;
    }
    EXPECT_LE(worst_time_inside_s(rows[i]), inside_s[i]);
  }
}

// Between two kicks the axis rests within so wide a tolerance, and further away than it is certified to end.
TEST(BrakedAxis, HasNotSettledBeforeTheLawHoldsHoweverWideTheToleranceIsThatIsJudged) {
  auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
  axis.node.settle_tolerance_m = 1e-3;
  axis.run->settle_time_s = 0;
  const double count_m = axis.node.axes[0].drive->encoder_resolution_m;
  for (const auto& row : study::run_study(axis, three_starts(10))) {
    for (const auto& run : row.runs) {
      EXPECT_TRUE(run.settled) << run.law;
      EXPECT_LE(std::abs(run.final_error_m), axis.node.axes[0].controller.position_tolerance_m + count_m / 2)
          << run.law;
    }
  }
}

// What is certified must not be stopped for a force that its slow current loop still has.
TEST(BrakedAxis, SettlesBehindACurrentLoopOfTwentyPeriods) {
  auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
  axis.node.axes[0].drive->current_loop_time_constant_s = 0.02;
  axis.node.axes[0].controller.position_tolerance_m = 9e-5;
  axis.node.settle_tolerance_m = 1e-4;
  ASSERT_TRUE(config::examine(axis.node).front().certified);
  const auto result = sil::run_loop_scenario(axis, {});
  EXPECT_TRUE(result.axes[0].faults.empty()) << result.axes[0].faults[0].name;
  EXPECT_TRUE(result.axes[0].settled);
}

TEST(BrakedAxis, SaysWhichFrictionItsKicksShowWhenItWasToldAnother) {
  auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
  axis.worlds[0].friction = {{0.6, 0.6}, model::shape::constant(0)};  // the brake of 2.2 N drives it back
  const auto result = sil::run_loop_scenario(axis, {});
  ASSERT_EQ(result.axes[0].faults.size(), 1U);
  const std::string& name = result.axes[0].faults[0].name;
  const std::string said = "axis not as told: a kick showed friction of about ";
  ASSERT_EQ(name.find(said), 0U) << name;
  // From nothing up to the brake, which drove the axis back.
  const double shown_N = std::stod(name.substr(said.size()));
  EXPECT_TRUE(shown_N >= 0 && shown_N < 2.21) << name;
  EXPECT_NE(name.find("told are 2.5 to 4.5 N"), std::string::npos) << name;
}

TEST(ImpulsiveAxis, ReachesTheTargetInDoubleAndWithNaivePulsesToo) {
  auto axis = scenario::read_scenario(scenarios + "can_axis.toml");
  axis.scalar = scenario::ScalarType::float64;
  for (const auto& row : study::run_study(axis, three_starts(10))) EXPECT_EQ(settled_runs(row), row.runs.size());
  axis.node.axes[0].controller.impulsive->kick = config::Kick::naive;
  axis.node.settle_tolerance_m = 10e-6;  // the naive pulse overshoots: its floor is 4 Ts^2 times 1 m/s^2 and more
  for (const auto& row : study::run_study(axis, three_starts(10))) EXPECT_EQ(settled_runs(row), row.runs.size());
}

TEST(PidAxis, DoesNotSettleUnderEveryLaw) {
  const auto axis = scenario::read_scenario(scenarios + "can_axis_pid.toml");
  std::size_t settled = 0, runs = 0;
  for (const auto& row : study::run_study(axis, three_starts(10))) {
    settled += settled_runs(row);
    runs += row.runs.size();
    EXPECT_LE(largest_force_N(row), 50);
  }
  EXPECT_LT(settled, runs) << "then the class of friction laws is too easy to show anything";
}

// Where an axis stands when it begins is what its file says of its home: a study moves both.
TEST(AxisThatStandsAtHome, SettlesFromEveryStartOfAStudy) {
  auto axis = scenario::read_scenario(scenarios + "braked_axis.toml");
  axis.node.axes[0].drive->homing.home = cia402::Home::here;
  study::StudyOptions options;
  options.starts = {{-0.1, 0}, {-0.01, 0}, {0.02, 0}};
  options.random_laws = 1;
  for (const auto& row : study::run_study(axis, options)) {
    EXPECT_EQ(settled_runs(row), row.runs.size()) << row.start.position_m;
    EXPECT_LE(worst_error_m(row), 3e-6) << row.start.position_m;
    study::require_within_limits(axis, row.start);
  }
  const std::string problem = scenario::start_problem(axis.node.axes[0], axis.worlds[0], -0.1);
  EXPECT_NE(problem.find("home_position_m = 0; give both the same"), std::string::npos) << problem;
  EXPECT_EQ(scenario::start_problem(axis.node.axes[0], axis.worlds[0], 0), "");
}

TEST(BusScenario, GivesTheSameResultTwice) {
  const auto axis = scenario::read_scenario(scenarios + "can_axis.toml");
  const auto first = sil::run_loop_scenario(axis, {}), second = sil::run_loop_scenario(axis, {.trace = true});
  EXPECT_EQ(first.axes[0].final_error_m, second.axes[0].final_error_m);
  EXPECT_EQ(first.axes[0].settling_time_s, second.axes[0].settling_time_s);
  ASSERT_EQ(first.axes[0].kicks.size(), second.axes[0].kicks.size());
}

TEST(BusScenario, FollowsTargetChangesAtAnyTime) {
  auto axis = scenario::read_scenario(scenarios + "can_axis.toml");
  axis.node.axes[0].controller.targets = {{0.05, 0.3}, {0.4, -0.2}, {2.0, 0.1234565}};
  const auto result = sil::run_loop_scenario(axis, {});
  EXPECT_TRUE(result.settled());
  EXPECT_LT(result.axes[0].settling_time_s, 1.0) << "counted from the last change";
  EXPECT_GT(result.duration_s, 2.0);
  // A target is a whole encoder count: half a count more than the tolerance.
  EXPECT_LE(std::abs(result.axes[0].final_error_m), 3e-6);
}

TEST(ThreeAxes, OfOneFileSettleEachUnderItsOwnFriction) {
  auto axes = scenario::read_scenario(scenarios + "three_axes.toml");
  const auto result = sil::run_loop_scenario(axes, {});
  ASSERT_EQ(result.axes.size(), 3U);
  for (std::size_t i = 0; i < result.axes.size(); ++i) {
    const auto& axis = result.axes[i];
    EXPECT_TRUE(axis.settled) << axis.name;
    EXPECT_TRUE(axis.faults.empty()) << axis.name;
    EXPECT_LE(std::abs(axis.final_error_m), judged_tolerance_m(axes.node, axes.node.axes[i])) << axis.name;
  }
  EXPECT_EQ(result.loop->missed_ticks, 0U);
}

TEST(Axes, SettleTogetherAtTheRateThatTheBusAllows) {
  for (const auto& [axes, period] : {std::pair<std::size_t, hal::Duration>{2, 1ms}, {8, 3ms}}) {
    Rig rig{{.axes = axes, .period = period, .friction = {{2.5, 4.5}, model::shape::static_kinetic(1, 0)}}};
    ASSERT_EQ(rig.loop().check_bus(), canopen::BusFit::fits);
    ASSERT_TRUE(rig.start()) << axes;
    rig.run(4s);
    for (std::size_t i = 0; i < axes; ++i) {
      SCOPED_TRACE(i);
      EXPECT_EQ(rig.status(i).fault, firmware::AxisFault::none) << to_string(rig.status(i).fault);
      EXPECT_EQ(rig.status(i).output.mode, law::Mode::hold);
      EXPECT_LE(std::abs(rig.position_m(i)), rig.parameters().position_tolerance_m + 1e-6);
      EXPECT_TRUE(rig.slide(i).sticking());
    }
  }
}

TEST(Axis, StaysWhereItIsOnceItHolds) {
  Rig rig{{.friction = {{2.5, 4.5}, model::shape::random_dwell({.seed = 4})}}};
  ASSERT_TRUE(rig.start());
  rig.run(2s);
  const double held_m = rig.position_m(0);
  const auto kicks = rig.loop().controller(rig.id(0)).kicks();
  rig.run(20s);
  EXPECT_EQ(rig.position_m(0), held_m);
  EXPECT_EQ(rig.loop().controller(rig.id(0)).kicks(), kicks);
}

}  // namespace
}  // namespace breakaway::closed_loop
