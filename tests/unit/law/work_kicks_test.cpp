// The parts of the coast "work": the meter that ends a pulse, the rest that waits for the other mass, the move that
// leaves nothing swinging, and the names with which a run ends.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
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
}

}  // namespace
}  // namespace breakaway::law
