// The parts that a table of the coast "brake" and its promise are made of, where the law of a whole axis hardly gets.
#include "../../../controller/design/src/kick_class.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../../controller/design/src/kick_table_builder.hpp"
#include "../../../controller/design/src/kick_time.hpp"
#include "../../kicked_axis.hpp"
#include "breakaway/design/kick_promise.hpp"
#include "breakaway/design/pulse_travel.hpp"

namespace breakaway::design {
namespace {

using breakaway::testing::axes_of_the_scenes;
using detail::KickClass;
using detail::KickTableBuilder;
using detail::KickTime;

TEST(KickClass, KnowsPulsesWithoutACut) {
  const BrakedClass c = axes_of_the_scenes(2e-3);
  const KickClass kicks{c};
  const auto uncut_m = [&](double friction_N, double start_N) {
    return travel_m({.start_N = start_N, .pulse_N = 20, .pulse_s = 10e-3, .brake_N = kicks.brake_N()},
                    {1, friction_N, 2e-3});
  };
  EXPECT_DOUBLE_EQ(most_travel_m(c, 20, 10, 0), uncut_m(2.5, kicks.most_start_N()));
  EXPECT_DOUBLE_EQ(least_travel_m(c, 20, 10, 0), uncut_m(4.5, kicks.preload_N()));
  EXPECT_EQ(kicks.cut_N(20, 10, 0), 0);
  EXPECT_GT(kicks.cut_N(20, 10, 3), 0);
}

// The lemma of the end of a cut, with jitter: for every loop of the class, and for those beyond its slowest.
TEST(KickClass, CutsNoLoopToBelowTheBrake) {
  std::mt19937_64 bits{7};
  std::uniform_real_distribution<double> unit{0, 1};
  for (int number = 0; number < 20000; ++number) {
    BrakedClass c = axes_of_the_scenes(0);
    c.lag_s.least = c.period_s * std::pow(10, 3 * unit(bits) - 1.5);
    c.lag_s.most = c.lag_s.least * (1 + unit(bits));
    if (number % 2 == 0) c.jitter_s = 0.5 * unit(bits) * c.period_s;
    const KickClass kicks{c};
    const double force_N = 3 + 47 * unit(bits), slower_s = c.lag_s.least * std::pow(1e4, unit(bits));
    const int periods = 1 + static_cast<int>(30 * unit(bits)), cut = kicks.cut_periods(force_N, periods);
    const double left = std::exp(-periods * kicks.shortest_period_s() / slower_s);
    const double left_of_cut = std::exp(-cut * kicks.longest_period_s() / slower_s);
    const double end_N = force_N + (kicks.preload_N() - force_N) * left, cut_N = kicks.cut_N(force_N, periods, cut);
    ASSERT_GE(-cut_N + (cut_N + end_N) * left_of_cut, -kicks.brake_N() - 1e-9) << "kick " << number;
  }
}

TEST(KickClass, CutsForNoLongerThanATableCanHold) {
  EXPECT_LT(KickClass{axes_of_the_scenes(0.1)}.cut_periods(50, 20), 255);
  const KickClass slow{axes_of_the_scenes(10)};
  EXPECT_EQ(slow.cut_periods(50, 20), 255);
  EXPECT_GT(slow.cut_N(50, 20, 255), slow.limit_N());
}

// The travel of a pulse is computed with its whole cut. What the drive cannot give is no part of a promise.
TEST(KickClass, IsOfNoUseBehindACurrentLoopThatNoCutWithinTheForceBringsDown) {
  for (const double lag_s : {0.4, 1.0, 2.0}) {
    const auto design = design_braked_kicks<float>(axes_of_the_scenes(lag_s));
    EXPECT_EQ(design.breaks_away, lag_s < 0.5) << lag_s;
    EXPECT_EQ(design.possible(), lag_s < 0.5) << lag_s;
    EXPECT_EQ(std::isinf(design.pulse_needed_N), lag_s > 0.5) << lag_s;
  }
}

// Few steps of force, each pulse known by itself.
BrakedClass listed_axes(double max_force_N) {
  BrakedClass c = axes_of_the_scenes(0);
  c.force_step_N = 1;
  c.max_force_N = max_force_N;
  return c;
}

TEST(KickTableBuilder, ListsAllPulsesForADistanceBelowThemAll) {
  const BrakedClass c = listed_axes(20);
  const KickClass kicks{c};
  KickTableBuilder<double> near{c, kicks}, far{c, kicks};
  near.build(0);
  far.build(1e-3);
  ASSERT_GT(near.table().count, 0);
  // The least sure force is 5 N for a period: (5 - 2.5) (5 + 2) T^2 / (2 (2.5 + 2)).
  EXPECT_NEAR(near.table().entries[0].a0, 2.5 * 7 * 1e-6 / 9, 1e-15);
  EXPECT_LE(far.table().entries[0].a0, 1e-3 * (1 + 1e-12));
  EXPECT_GT(far.table().entries[1].a0, 1e-3);
}

TEST(KickTableBuilder, ReachesNothingWhereNoPulseIsSureToMove) {
  const BrakedClass c = listed_axes(4);
  const KickClass kicks{c};
  KickTableBuilder<double> builder{c, kicks};
  builder.build(1e-6);
  EXPECT_EQ(builder.table().count, 0);
  EXPECT_TRUE(std::isinf(builder.range_m().least));
  EXPECT_EQ(builder.range_m().most, 0);
}

// Behind a current loop of 2 ms.
struct LateAxis {
  BrakedClass c = axes_of_the_scenes(2e-3);
  law::BrakedKicks<double> kicks = design_braked_kicks<double>(c).kicks;

  double periods() const { return KickTime{c, kicks}.periods(20, 10, 4, 10); }
};

TEST(KickTime, HasTheLongerProofOfRestWhereTheBrakeIsTakenOffBeforeTheAxisRests) {
  const LateAxis in_time;
  LateAxis late = in_time;
  late.kicks.coast_per_N = 0, late.kicks.settling_periods = 0;
  EXPECT_EQ(late.periods(), in_time.periods() + late.kicks.either_way_periods + late.c.latency_periods + 2);
}

TEST(KickTime, WaitsForACalmForceNoLongerThanTheControllerDoes) {
  LateAxis patient, impatient, more_so;
  patient.kicks.coast_per_N = impatient.kicks.coast_per_N = more_so.kicks.coast_per_N = 1;  // no second proof
  patient.kicks.resting_force_N = impatient.kicks.resting_force_N = more_so.kicks.resting_force_N =
      -2 * patient.kicks.brake_N;  // to which the brake never leads
  patient.kicks.patient_periods = 2000;
  impatient.kicks.patient_periods = 501, more_so.kicks.patient_periods = 500;
  EXPECT_EQ(impatient.periods(), more_so.periods() + 1);
  EXPECT_LT(impatient.periods(), patient.periods());
}

}  // namespace
}  // namespace breakaway::design
