// The coast "work": the meter that ends a pulse, what its kicks aim at and hold back, and the names with which a run
// ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "../../two_mass_axis.hpp"
#include "belt_fixture.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::law::work_test {
namespace {

template <class Real>
class WorkLaw : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(WorkLaw, Scalars);

TYPED_TEST(WorkLaw, SettlesABeltFromFarAndNearWithoutAKickBeyond) {
  const auto design = design::design_work_kicks<TypeParam>(belt());
  ASSERT_TRUE(design.possible());
  const breakaway::testing::Friction strong = [](const breakaway::testing::Moment&) { return 2.25; },
                                     weak = [](const breakaway::testing::Moment&) { return 1.25; };
  for (const double start_m : {-0.1, -0.01, 2e-3, 5e-4}) {
    for (const auto& friction : {std::array{strong, strong}, std::array{weak, weak}, std::array{strong, weak}}) {
      const auto end = breakaway::testing::run_axis<TypeParam>(
          parameters_of<TypeParam>(belt(), design.least_tolerance_m), K3Table<TypeParam>{}, design.kicks,
          breakaway::testing::TwoMassAxis{*belt().spring_load, 0.02, {}, friction, start_m}, 1, 10, 1);
      EXPECT_TRUE(end.held) << start_m << ": " << to_string(end.fault);
      EXPECT_LE(end.beyond_m, 0.5e-6 * (1 + 1e-6)) << start_m;
      EXPECT_LE(end.time_s, 1) << start_m;
    }
  }
}

// The plan to a target that moves to just before an axis is so short that the axis passes it at nearly all of its
// speed.
TEST(WorkLawEnds, InAHoldWhereTheTargetMovesToWhereTheAxisIs) {
  const auto design = design::design_work_kicks<float>(belt());
  for (const double friction_N : {1.25, 2.25}) {
    const breakaway::testing::Friction friction = [=](const breakaway::testing::Moment&) { return friction_N; };
    const auto end = breakaway::testing::run_axis<float>(
        parameters_of<float>(belt(), design.least_tolerance_m), K3Table<float>{}, design.kicks,
        breakaway::testing::TwoMassAxis{*belt().spring_load, 0.02, {}, {friction, friction}, -5}, 1, 30, 1, 200, 0.3,
        {.at_s = 0.3, .shift_m = -3.6});
    EXPECT_TRUE(end.held) << friction_N << " N: " << to_string(end.fault) << " at " << end.time_s << " s, "
                          << end.error_m << " m away";
  }
}

// A motor that speeds up without a load, as far as the meter lets it.
TEST(WorkMeter, GivesNoPeriodWhoseWorkFrictionMayNotTake) {
  const auto kicks = design::design_work_kicks<double>(belt()).kicks;
  const double distance_m = 1e-3, T = 1e-3, q = 1e-6;
  for (const std::uint8_t latency : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{2}}) {
    WorkKicks<double> late = kicks;
    late.late_periods = latency + 1;
    WorkCycle<double> cycle{late, q, 50, latency};
    cycle.set_period(T);
    std::vector<double> x(10, 0.0);  // at the start of each period
    const auto see = [&] { cycle.see(x[x.size() - 1 - latency]); };
    see();
    cycle.kick(1, distance_m, {10, 100, 0});
    double v = 0;
    int given = 0;
    for (int k = 0; k < 100; ++k) {
      const double force_N = cycle.next_steps(0) * late.force_step_N;
      if (!(force_N > 0)) break;
      ++given;
      const double a = (force_N - late.held_back_N) / 0.4;
      x.push_back(x.back() + v * T + a * T * T / 2);
      v += a * T;
      see();
    }
    const double most_m = late.friction_per_gain_N * (distance_m - late.spring_m) / 10;
    EXPECT_LE(x.back(), most_m) << +latency;
    EXPECT_GT(given, latency) << +latency;
    EXPECT_LT(given, 100) << "then the meter ended nothing";
    EXPECT_GT(x.back() + 2 * v * T * (latency + 2), most_m) << "then it ended too soon, latency " << +latency;
  }
}

// What the spring may have pushed the motor by is more than the force, so that the meter expects no more speed.
TEST(WorkMeter, ExpectsNoSpeedOfAForceThatTheSpringMayHoldBack) {
  WorkKicks<double> kicks = design::design_work_kicks<double>(belt()).kicks;
  kicks.held_back_N = 20;
  kicks.late_periods = 1;
  const double distance_m = kicks.spring_m + 1e-4, q = 1e-6;
  WorkCycle<double> cycle{kicks, q, 50, 0};
  cycle.set_period(1e-3);
  cycle.see(0);
  cycle.kick(1, distance_m, {10, 100, 0});
  const double most_m = kicks.friction_per_gain_N * 1e-4 / cycle.pulse_N() - 2 * q, step_m = most_m / 20.5;
  ASSERT_LT(step_m, kicks.speeding_s_per_kg * 1e-3) << "else a newton more would not be noticed";
  int given = 0;
  for (int k = 1; k < 100 && cycle.next_steps(0) > 0; ++k) {
    ++given;
    cycle.see(k * step_m);
  }
  EXPECT_EQ(given, 20) << "with the twenty-first step it would be beyond";
}

// A motor that speeds up without a load, as far as the meter lets it, while these readings are lost.
double travel_m(const WorkKicks<double>& kicks, const std::vector<int>& lost, double distance_m) {
  const double T = 1e-3;
  WorkCycle<double> cycle{kicks, 1e-6, 50, 1};
  cycle.set_period(T);
  std::vector<double> x(10, 0.0);
  cycle.see(0);
  cycle.kick(1, distance_m, {10, 100, 0});
  double v = 0;
  for (int k = 1; k < 100; ++k) {
    const double force_N = cycle.next_steps(0) * kicks.force_step_N;
    if (!(force_N > 0)) break;
    const double a = (force_N - kicks.held_back_N) / 0.4;
    x.push_back(x.back() + v * T + a * T * T / 2);
    v += a * T;
    if (std::ranges::find(lost, k) == lost.end())
      cycle.see(x[x.size() - 2]);
    else
      cycle.skip();
  }
  return x.back();
}

TEST(WorkMeter, GivesNoPeriodWhoseWorkFrictionMayNotTakeWhileReadingsAreLost) {
  auto kicks = design::design_work_kicks<double>(belt()).kicks;
  const double distance_m = 1e-3, most_m = kicks.friction_per_gain_N * (distance_m - kicks.spring_m) / 10;
  for (int first = 1; first < 30; ++first)
    for (int last = first; last < first + 5; ++last) {
      std::vector<int> lost;
      for (int k = first; k <= last; ++k) lost.push_back(k);
      EXPECT_LE(travel_m(kicks, lost, distance_m), most_m) << first << " to " << last;
    }
  EXPECT_GT(travel_m(kicks, {2}, distance_m), 0.4 * most_m) << "a pulse goes on with what is left of it";
  kicks.metered = false;
  EXPECT_GT(travel_m(kicks, {2}, distance_m), 10 * most_m) << "nothing measures this pulse";
}

TEST(WorkMeter, LeavesAPulseAloneWhereTheEncoderIsOnTheLoad) {
  auto kicks = design::design_work_kicks<float>(belt()).kicks;
  kicks.metered = false;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.set_period(1e-3F);
  cycle.see(0);
  cycle.kick(1, 1e-3F, {10, 20, 0});
  int given = 0;
  for (int k = 0; k < 40; ++k) {
    given += cycle.next_steps(0) > 0;
    cycle.see(static_cast<float>(k));
  }
  EXPECT_EQ(given, 20);
}

TEST(WorkAim, RefusesAtItsFloorNothingAndWhatTheSpringMayAddAll) {
  const auto design = design::design_work_kicks<float>(belt());
  const WorkAim<float> aim{design.kicks, parameters_of<float>(belt(), design.least_tolerance_m)};
  EXPECT_EQ(aim.refusal(design.kicks.spring_m), ControlFault::spring_limit);
  EXPECT_EQ(aim.refusal(-design.kicks.table.least_m()), ControlFault::none);
  EXPECT_EQ(aim.refusal(std::nextafter(design.kicks.table.least_m(), 0.0F)), ControlFault::below_floor);
}

TEST(WorkAim, KeepsOfTheToleranceWhatTheSpringMayMoveAHeldAxisBy) {
  const auto design = design::design_work_kicks<float>(belt());
  ASSERT_GT(design.creep_m, 0);
  const WorkAim<float> aim{design.kicks, parameters_of<float>(belt(), 2 * design.least_tolerance_m)};
  EXPECT_EQ(aim.tolerance_m(), static_cast<float>(2 * design.least_tolerance_m) - design.kicks.creep_m);
}

// How far the spring of an axis that rests moves its motor where that side's friction falls to its least.
double crept_m(const design::BrakedClass& c, double load_N) {
  const design::SpringLoad& load = *c.spring_load;
  const double held_N = std::min(load.motor_friction.upper_N, load.load_friction.upper_N);
  const double from_m = held_N / load.stiffness_N_per_m + load.gap_m / 2, h = 1e-6;
  const std::array<double, 2> mass_kg{load.motor_kg, load.load_kg}, friction_N{load.motor_friction.lower_N, load_N};
  std::array<double, 2> x{from_m, 0}, v{};
  for (int k = 0; k < 200'000; ++k) {
    const double apart_m = x[0] - x[1], half_m = load.gap_m / 2;
    const double pull_N = load.stiffness_N_per_m * (apart_m - std::clamp(apart_m, -half_m, half_m));
    for (const std::size_t side : {0U, 1U}) {
      const double free_m_s = v[side] + (side == 0 ? -pull_N : pull_N) * h / mass_kg[side];
      const double most_m_s = friction_N[side] * h / mass_kg[side];
      v[side] = free_m_s - std::clamp(free_m_s, -most_m_s, most_m_s);
      x[side] += v[side] * h;
    }
  }
  return from_m - x[0];
}

TEST(WorkLawHolds, BackAllThatTheBentSpringMayMoveAnAxisByWhereFrictionFalls) {
  for (const double gap_m : {0.0, 2e-5, 1e-3})
    for (const double load_N : {1.25, 1.7, 2.25}) {
      design::BrakedClass c = belt();
      c.spring_load->gap_m = gap_m;
      c.encoder_resolution_m = 2e-3;
      const double kept_m = design::design_work_kicks<double>(c).creep_m, crept = crept_m(c, load_N);
      EXPECT_LE(crept, kept_m) << gap_m << ", " << load_N;
      if (gap_m == 0) {
        EXPECT_GT(crept, 0.45 * kept_m) << "else too much is kept";
      }
    }
}

TEST(WorkLawHolds, NothingBackWhereTheSideThatIsReadHoldsAllThatTheSpringPulls) {
  design::BrakedClass c = belt();
  c.spring_load->load_friction = {0.8, 1.25};
  EXPECT_EQ(design::design_work_kicks<double>(c).creep_m, 0);
  c.spring_load->load_friction.upper_N = 1.3;
  EXPECT_DOUBLE_EQ(design::design_work_kicks<double>(c).creep_m, 1.5 * c.encoder_resolution_m);
  c.encoder_resolution_m = 1e-3;
  const auto coarse = design::design_work_kicks<double>(c);
  EXPECT_DOUBLE_EQ(coarse.creep_m, coarse.spring_m);
}

TEST(WorkAim, GivesSixtyFourKicksToATarget) {
  const auto design = design::design_work_kicks<float>(belt());
  const auto p = parameters_of<float>(belt(), design.least_tolerance_m);
  WorkAim<float> aim{design.kicks, p};
  const auto far_m = static_cast<float>(3 * design.floor_m);
  for (int round = 0; round < 2; ++round) {
    for (int kick = 0; kick < WorkAim<float>::most_kicks; ++kick) {
      EXPECT_EQ(aim.refusal(far_m), ControlFault::none) << kick;
      static_cast<void>(aim.pulse(far_m));
    }
    EXPECT_EQ(aim.refusal(-far_m), ControlFault::hunting);
    aim.restart();
  }
}

// Its plan would go on for a thousand seconds.
TEST(WorkLawEnds, AnApproachThatDrivesTheAxisToAndFroByAllForce) {
  const auto design = design::design_work_kicks<float>(belt(), 1e-3);
  auto p = parameters_of<float>(belt(), design.least_tolerance_m);
  p.max_approach_speed_m_s = 1e-3F;
  const K3Table<float> unused;
  AxisController<float, WorkKicks<float>> controller{p, unused, design.kicks};
  int periods = 0;
  for (; controller.mode() == Mode::approach && periods < 100'000; ++periods) {
    const float swing_m = periods / 10 % 2 == 0 ? 0.5F : -0.5F;
    static_cast<void>(controller.update({1 + swing_m, 0, true}));
  }
  EXPECT_LE(periods, 1000);
  EXPECT_EQ(controller.fault(), ControlFault::none);
}

// Where an axis that does not move at all ends.
ControlFault end_of_stuck_axis(double at_m, double tolerance_m) {
  const auto design = design::design_work_kicks<float>(belt());
  const K3Table<float> unused;
  AxisController<float, WorkKicks<float>> controller{parameters_of<float>(belt(), tolerance_m), unused, design.kicks};
  for (int k = 0; k < 200000; ++k) {
    static_cast<void>(controller.update({static_cast<float>(at_m), 0, true}));
    if (controller.mode() == Mode::hold || controller.fault() != ControlFault::none) break;
  }
  return controller.fault();
}

TEST(WorkLawEnds, ByNameWhereNoKickWouldBeRight) {
  const auto design = design::design_work_kicks<float>(belt());
  EXPECT_EQ(end_of_stuck_axis(design.spring_m * 0.9, design.spring_m * 0.5), ControlFault::spring_limit);
  EXPECT_EQ(end_of_stuck_axis((design.spring_m + design.floor_m) / 2, design.spring_m * 0.5),
            ControlFault::below_floor);
  EXPECT_EQ(end_of_stuck_axis(design.floor_m * 3, design.least_tolerance_m), ControlFault::jammed);
  EXPECT_EQ(end_of_stuck_axis(design.floor_m * 0.9, design.least_tolerance_m), ControlFault::none);
  const double asked_m = 4 * design.floor_m;
  EXPECT_EQ(end_of_stuck_axis(asked_m - 1.01 * design.creep_m, asked_m), ControlFault::none);
  EXPECT_EQ(end_of_stuck_axis(asked_m - 0.9 * design.creep_m, asked_m), ControlFault::jammed)
      << "this much the spring might move it out of its tolerance";
}

}  // namespace
}  // namespace breakaway::law::work_test
