// The rest of the coast "work", which waits for the mass that nobody reads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "belt_fixture.hpp"
#include "breakaway/design/work_kicks.hpp"
#include "breakaway/law/axis_controller.hpp"

namespace breakaway::law::work_test {
namespace {

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

// The target moves in the period in which a pulse begins.
TEST(WorkCycle, TellsOfNoPulseOnceItBeginsAnew) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.set_period(1e-3F);
  cycle.see(-1e-3F);
  cycle.kick(1, 1e-3F, {10, 3, 0});
  cycle.next_steps(0);
  ASSERT_TRUE(cycle.pulse_starts());
  cycle.restart();
  cycle.next_free_steps(0);
  EXPECT_FALSE(cycle.pulse_starts());
  EXPECT_FALSE(cycle.pulsed());
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

// An approach leaves it a speed as a kick does.
TEST(WorkCycle, WaitsAfterAnApproachForWhatAKickMayTakeAsWell) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  cycle.brake(1, 100);
  int periods = 0;
  for (; !cycle.overdue() && periods < 100000; ++periods) EXPECT_EQ(cycle.next_steps(7), 0);
  EXPECT_EQ(periods, 4 * (100 + kicks.longest_coast_periods + kicks.still_periods));
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
}

TEST(WorkCycle, NoticesAnApproachThatAsksForMoreThanAllForceToAndFro) {
  const auto kicks = design::design_work_kicks<float>(belt()).kicks;
  WorkCycle<float> cycle{kicks, 1e-6F, 50, 1};
  const std::int32_t all = cycle.within_limit(1'000'000);
  const auto times_until_noticed = [&](std::int32_t most) {
    int times = 0;
    for (; !cycle.driven_to_and_fro() && times < 1000; ++times) {
      EXPECT_EQ(cycle.next_steps(most), std::min(most, all));
      cycle.next_steps(most / 2);
      EXPECT_EQ(cycle.next_steps(-most), -std::min(most, all));
    }
    return times;
  };
  EXPECT_EQ(times_until_noticed(all), 1000) << "all that there is may be asked for";
  const int times = times_until_noticed(all + 1);
  EXPECT_GT(times, 4);
  EXPECT_LE(times, 16);
  cycle.restart();
  EXPECT_FALSE(cycle.driven_to_and_fro());
  for (int k = 0; k < 1000; ++k) cycle.next_steps(all + 1);
  EXPECT_FALSE(cycle.driven_to_and_fro()) << "one way only";
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

}  // namespace
}  // namespace breakaway::law::work_test
