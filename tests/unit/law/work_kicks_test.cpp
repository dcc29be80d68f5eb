// The parts of the coast "work": the meter that ends a pulse, the rest that waits for the other mass, the move that
// leaves nothing swinging, and the names with which a run ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "../../two_mass_axis.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::law {
namespace {

// 1 kg, two fifths of it the motor's, 2.5 to 4.5 N, that swings 50 times a second.
design::BrakedClass belt() {
  design::BrakedClass c = breakaway::testing::axes_of_the_scenes(0);
  design::SpringLoad load{.motor_kg = 0.4,
                          .load_kg = 0.6,
                          .stiffness_N_per_m = 0.24 * std::pow(2 * std::numbers::pi * 50, 2),
                          .motor_friction = {1.25, 2.25},
                          .load_friction = {1.25, 2.25}};
  c.spring_load = load;
  return c;
}

template <class Real>
AxisParameters<Real> parameters_of(const design::BrakedClass& c, double tolerance_m) {
  AxisParameters<Real> p;
  p.mass_kg = 1;
  p.stiffness_N_per_m = 100;
  p.approach_damping_Ns_per_m = 15;
  p.kick_damping_Ns_per_m = 25;
  p.friction = {static_cast<Real>(c.friction.lower_N), static_cast<Real>(c.friction.upper_N)};
  p.max_force_N = static_cast<Real>(c.max_force_N);
  p.max_approach_speed_m_s = 10;
  p.position_tolerance_m = static_cast<Real>(tolerance_m);
  p.encoder_resolution_m = static_cast<Real>(c.encoder_resolution_m);
  p.period_s = static_cast<Real>(c.period_s);
  p.coast = Coast::work;
  return p;
}

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

TEST(WorkCycle, TakesAnAxisForRestingOnlyAfterTheOtherMassCanHaveSwungOut) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.set_period(1e-3F);
  cycle.see(0);
  cycle.release(0);
  int waited = 0;
  while (!cycle.at_rest() && waited < 10000) cycle.see(0), ++waited;
  EXPECT_GE(waited, kicks.still_periods);
  // A swing of the load of 0.6 kg beside a motor that sticks takes 2 pi sqrt(m2 / K).
  EXPECT_GE(kicks.still_periods * 1e-3, std::numbers::pi * std::sqrt(0.6 / belt().spring_load->stiffness_N_per_m));
  cycle.see(1e-6F);
  EXPECT_FALSE(cycle.at_rest()) << "a count starts the wait anew";
}

// A motor that is let go half a count from where a load that sticks would have it.
double swings_within_a_count_s(const design::BrakedClass& c) {
  const design::SpringLoad& load = *c.spring_load;
  const double K = design::most_stiffer * load.stiffness_N_per_m, A = load.motor_friction.lower_N, h = 1e-6;
  double x = c.encoder_resolution_m / 2, v = 0, time_s = 0, last_s = 0;
  while (time_s - last_s < 0.01) {
    const double free_m_s = v - K * x * h / load.motor_kg, most_m_s = A * h / load.motor_kg;
    v = free_m_s - std::clamp(free_m_s, -most_m_s, most_m_s);
    x += v * h;
    time_s += h;
    if (v != 0) last_s = time_s;
  }
  return last_s;
}

TEST(WorkCycle, WaitsForASwingThatTheCountDoesNotShow) {
  for (const double q : {1e-6, 2e-4, 2e-3, 2e-2}) {
    design::BrakedClass c = belt();
    c.encoder_resolution_m = q;
    EXPECT_GE(design::design_work_kicks<double>(c).rest_s, swings_within_a_count_s(c)) << q;
  }
}

TEST(WorkCycle, LosesItsPatienceSoManyPeriodsAfterTheFirstReading) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  for (const float at_m : {0.0F, 0.3F}) {
    WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
    int readings = 0;
    for (; !cycle.patient() && readings < 100000; ++readings) cycle.see(at_m);
    EXPECT_EQ(readings, kicks.patient_periods + 1) << at_m;
  }
}

TEST(WorkCycle, TakesReadingsWithinTheNoiseForNoMotion) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 5e-6F, 50, 1};  // a count, and one of noise
  for (int k = 0; k <= kicks.patient_periods; ++k) cycle.see(k % 2 == 0 ? 0 : 2e-6F);
  EXPECT_TRUE(cycle.patient());
  cycle.see(3e-6F);
  EXPECT_FALSE(cycle.patient());
}

TEST(WorkCycle, AReadingAtTheEdgeOfTheNoiseIsNoMotion) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  for (const float side : {1.0F, -1.0F}) {
    WorkCycle<float> cycle{kicks, 0x1p-19F, 50, 1};
    cycle.see(side * 0x1p-20F);
    for (int k = 0; k < kicks.patient_periods; ++k) cycle.see(0);
    EXPECT_TRUE(cycle.patient());
  }
}

TEST(WorkCycle, IsOverdueAfterFourTimesWhatItsRestMayTake) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  for (const bool seen : {false, true}) {
    cycle = {kicks, 1e-6F, 50, 1};
    if (seen) cycle.see(0);
    cycle.release(100);
    int periods = 0;
    for (; !cycle.overdue() && periods < 100000; ++periods) EXPECT_EQ(cycle.next_steps(7), 0);
    EXPECT_EQ(periods, 4 * (100 + kicks.still_periods));
  }
  cycle.kick(-1, 1e-3F, {10, 3, 0});
  EXPECT_NEAR(cycle.pulse_N(), 10, 1e-5);
}

TEST(WorkCycle, BeginsAnewWhereItIsRestarted) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  for (int k = 0; k < 5; ++k) cycle.see(0);
  cycle.release(10);
  cycle.restart();
  EXPECT_EQ(cycle.next_steps(7), 7) << "the force comes from elsewhere";
  int readings = 0;
  for (; !cycle.patient() && readings < 100000; ++readings) cycle.see(0);
  EXPECT_EQ(readings, kicks.patient_periods + 1);
  cycle.release(10);
  EXPECT_EQ(cycle.next_steps(7), 0);
  cycle.set_free();
  EXPECT_EQ(cycle.next_steps(7), 7);
}

// Eight metres away a float steps by about a count.
TEST(WorkCycle, TakesTheLastDigitOfANumberForNoMotion) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  for (const float side : {1.0F, -1.0F}) {
    WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
    const float at_m = side * 8, next_m = std::nextafter(at_m, side * 9);
    for (int k = 0; k <= kicks.patient_periods; ++k) cycle.see(k % 2 == 0 ? at_m : next_m);
    EXPECT_TRUE(cycle.patient());
    cycle.see(std::nextafter(next_m, side * 9));
    EXPECT_FALSE(cycle.patient());
  }
}

TEST(WorkCycle, GivesOnePeriodAtLeastAndNoMoreForceThanThereIs) {
  auto kicks = design::design_work_kicks<float>(belt()).kicks;
  kicks.metered = false;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.set_period(1e-3F);
  cycle.see(0);
  cycle.kick(1, 1e-3F, {10, 0, 0});
  EXPECT_GT(cycle.next_steps(0), 0);
  EXPECT_EQ(cycle.next_steps(0), 0);
  cycle.kick(1, 1e-3F, {-10, 3, 0});
  EXPECT_EQ(cycle.pulse_N(), 0);
  cycle.limit_force(5);
  cycle.kick(1, 1e-3F, {10, 3, 0});
  EXPECT_NEAR(cycle.pulse_N(), 5, 1e-5);
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

// The force of a plan that nothing feeds back to, at this frequency.
double swing_left(const ShapedApproach<double>& approach, double start_m, double frequency_Hz) {
  ShapedMove<double> move{approach, 1e-3, 10, 1};
  std::complex<double> sum = 0;
  double all = 0;
  for (int k = 0; k < 5000 && !move.see(start_m, 0, 0); ++k) {
    const double force_N = move.force_N();
    sum += force_N * std::polar(1.0, -2 * std::numbers::pi * frequency_Hz * k * 1e-3);
    all += std::abs(force_N);
  }
  return std::abs(sum) / all;
}

TEST(ShapedMove, LeavesNothingSwingingAtTheResonance) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = 0;
  for (const double start_m : {-0.1, 0.037, -4e-3}) {
    EXPECT_LT(swing_left(approach, start_m, 50), 1e-12) << start_m;
    EXPECT_GT(swing_left(approach, start_m, 3), 1e-3) << start_m;
  }
}

TEST(ShapedMove, GoesAsFarAsItPlansAndKeepsItsLimits) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = 0;
  for (const double most_m_s : {10.0, 0.3}) {
    for (const double start_m : {-0.4, 0.1, 0.02}) {
      ShapedMove<double> move{approach, 1e-3, most_m_s, 1};
      double x = start_m, v = 0;
      while (!move.see(x, 0, 0)) {
        const double a = move.force_N() / approach.mass_kg;
        EXPECT_LE(std::abs(a), approach.acceleration_m_s2 * (1 + 1e-9));
        x += (v + a * 0.5e-3) * 1e-3;
        v += a * 1e-3;
        EXPECT_LE(std::abs(v), most_m_s * (1 + 1e-9));
      }
      EXPECT_NEAR(std::abs(x), approach.short_of_target_m, 1e-12) << start_m;
      EXPECT_NEAR(v, 0, 1e-12) << start_m;
    }
  }
}

// As fast as two periods of its acceleration, and as a hundredth of one.
TEST(ShapedMove, IsNoFasterThanItMayWhereAPeriodOfItsAccelerationAlreadyIs) {
  auto approach = design::design_work_kicks<float>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = approach.short_of_target_m = 0;
  for (const float share : {2.0F, 0.01F}) {
    const float most_m_s = share * approach.acceleration_m_s2 * 1e-3F;
    ShapedMove<float> move{approach, 1e-3F, most_m_s, 1};
    const double start_m = -2e5 * static_cast<double>(most_m_s) * 1e-3;
    double x = start_m, v = 0;
    while (!move.see(static_cast<float>(x), 0, 0)) {
      const double a = static_cast<double>(move.force_N() / approach.mass_kg);
      x += (v + a * 0.5e-3) * 1e-3;
      v += a * 1e-3;
      ASSERT_LE(std::abs(v), static_cast<double>(most_m_s) * (1 + 1e-5)) << share;
    }
    EXPECT_NEAR(x, 0, 1e-5 * std::abs(start_m)) << "rounding adds up over two hundred thousand periods, " << share;
  }
}

TEST(ShapedMove, GoesNoFasterWhereItsTargetIsFurtherThanItCountsPeriods) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.stiffness_N_per_m = approach.damping_Ns_per_m = approach.friction_N = 0;
  ShapedMove<double> move{approach, 1e-3, 0.1, 1};
  double x = -1000, v = 0, most_m_s = 0;
  while (!move.see(x, 0, 0)) {
    const double a = move.force_N() / approach.mass_kg;
    x += (v + a * 0.5e-3) * 1e-3;
    v += a * 1e-3;
    most_m_s = std::max(most_m_s, v);
  }
  EXPECT_LE(most_m_s, 0.1 * (1 + 1e-9));
  EXPECT_NEAR(v, 0, 1e-9);
  EXPECT_GT(x, -1000 + 0.5 * 0.1 * 1e-3 * ShapedMove<double>::most_planned_periods) << "it leads at least as far";
}

TEST(ShapedMove, SaysWhichWayItGoesAndForHowManyPeriods) {
  const auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  for (const double side : {1.0, -1.0}) {
    ShapedMove<double> move{approach, 1e-3, 10, 1};
    move.see(-side * 0.1, 0, 0);
    EXPECT_EQ(move.heading(), side);
    int periods = 0;
    for (; !move.see(-side * 0.1, 0, 0); ++periods) static_cast<void>(move.force_N());
    EXPECT_NEAR(move.braking_periods(), periods, 1);
  }
}

// Thirty thousand periods of speeding up are the most that it counts.
TEST(ShapedMove, CountsThePeriodsOfTheLongestWayAndTheHighestSpeed) {
  auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  approach.short_of_target_m = 0;
  approach.acceleration_m_s2 = 1;
  ShapedMove<double> move{approach, 1e-3, 1e9, 1};
  move.see(-1e-6 * 30000.0 * 40000.0, 0, 0);
  EXPECT_EQ(move.braking_periods(), 2 * 30000 + (40000 + 1 - 30000) + approach.swing_periods);
}

TEST(ShapedMove, BeginsAnewFromWhereTheAxisIsWhenItsTargetMoves) {
  const auto approach = design::design_work_kicks<double>(belt()).kicks.approach;
  ShapedMove<double> move{approach, 1e-3, 10, 1}, begun_there{approach, 1e-3, 10, 1};
  for (int k = 0; k < 20; ++k) {
    move.see(-0.1, 0, 0);
    static_cast<void>(move.force_N());
  }
  move.retarget(0.05);
  for (int k = 0; k < 200; ++k) {
    EXPECT_EQ(move.see(-0.15, 0, 0), begun_there.see(-0.15, 0, 0)) << k;
    EXPECT_EQ(move.force_N(), begun_there.force_N()) << k;
  }
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
}  // namespace breakaway::law
