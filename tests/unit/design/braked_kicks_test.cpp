#include "breakaway/design/braked_kicks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>

#include "breakaway/design/binding_limit.hpp"
#include "breakaway/design/k3.hpp"
#include "breakaway/design/kick_promise.hpp"

namespace breakaway::design {
namespace {

// The paper's mass and friction behind a drive of 50 N.
BrakedClass example(double period_s = 1e-3, double lag_s = 0, double force_step_N = 0.025) {
  BrakedClass c;
  c.lag_s = {lag_s, lag_s};
  c.friction = {2.5, 4.5};
  c.max_force_N = 50;
  c.force_step_N = force_step_N;
  c.period_s = period_s;
  c.encoder_resolution_m = 1e-9;  // does not limit
  return c;
}

constexpr double steps_N[] = {0.025, 0.5, 2, 5, 20};

// Of a prototype that is not in this tree, with its own search for the worst case, for each of the steps of force.
struct PrototypeFloors {
  double period_s, lag_s;
  double floors_um[std::size(steps_N)];
};

constexpr PrototypeFloors prototype[] = {
    {1e-3, 0, {1.52, 1.95, 3.11, 10, 70}},           {1e-3, 1e-4, {1.56, 1.85, 3, 9.4, 68}},
    {1e-3, 1e-3, {2.06, 2.44, 2.44, 7.2, 53}},       {1e-3, 5e-3, {4.25, 4.34, 5.4, 4.5, 115}},
    {1e-3, 2e-2, {17.9, 17.9, 18.7, 37, 962}},       {2.5e-4, 0, {0.095, 0.122, 0.194, 0.625, 4.38}},
    {2.5e-4, 1e-3, {0.256, 0.272, 0.297, 0.327, 9}}, {4e-3, 0, {24, 31, 50, 160, 1120}},
};

TEST(BrakedKicks, HaveTheFloorsOfTheClosedFormAndOfThePrototype) {
  for (const PrototypeFloors& row : prototype) {
    for (std::size_t i = 0; i < std::size(steps_N); ++i) {
      const auto design = design_braked_kicks<float>(example(row.period_s, row.lag_s, steps_N[i]));
      EXPECT_TRUE(design.possible());
      EXPECT_LE(1e6 * design.floor_m, 1.05 * row.floors_um[i])
          << row.period_s << " s, lag " << row.lag_s << " s, " << steps_N[i] << " N";
    }
  }
}

// At 1 ms and without lag; the last is behind a lag of a period, which is known to a fifth.
TEST(BrakedKicks, HaveTheFloorsOfThePrototypeWhereAnAxisIsUncertain) {
  const struct {
    const char* of;
    double most_um;
    void (*set)(BrakedClass&);
  } rows[] = {
      {"force gain", 2.7,
       [](BrakedClass& c) {
         c.force_gain = {0.9, 1.1};
       }},
      {"mass", 1.7,
       [](BrakedClass& c) {
         c.mass_kg = {0.9, 1.1};
       }},
      {"load of a fifth of the least friction", 2.9, [](BrakedClass& c) { c.load_N = 0.5; }},
      {"load of half the least friction", 7.6, [](BrakedClass& c) { c.load_N = 1.25; }},
      {"mass, force gain and lag", 7.9,
       [](BrakedClass& c) {
         c.mass_kg = c.force_gain = {0.9, 1.1};
         c.lag_s = {0.8e-3, 1.2e-3};
       }},
  };
  for (const auto& row : rows) {
    BrakedClass c = example();
    row.set(c);
    EXPECT_LE(1e6 * design_braked_kicks<float>(c).floor_m, 1.05 * row.most_um) << row.of;
  }
}

// The table "Floor in um" of the README, to the digits that it shows.
TEST(BrakedKicks, HaveTheFloorsThatTheReadmeShows) {
  std::ifstream file{BREAKAWAY_SOURCE_DIR "/controller/design/README.md"};
  int rows = 0;
  for (std::string line; std::getline(file, line);) {
    double period_ms = 0, lag_ms = 0;
    char shown[5][16] = {};
    if (std::sscanf(line.c_str(), "| %lf ms | %lf%*[ ms]| %15s | %15s | %15s | %15s | %15s |", &period_ms, &lag_ms,
                    shown[0], shown[1], shown[2], shown[3], shown[4]) != 7)
      continue;
    ++rows;
    for (int i = 0; i < 5; ++i) {
      const std::string text = shown[i];
      const auto point = text.find('.');
      const double digits = point == std::string::npos ? 0 : static_cast<double>(text.size() - point - 1);
      const double floor_um =
          1e6 * design_braked_kicks<float>(example(period_ms / 1e3, lag_ms / 1e3, steps_N[i])).floor_m;
      EXPECT_NEAR(floor_um, std::stod(text), 0.51 * std::pow(10, -digits)) << line << ", column " << i;
    }
  }
  EXPECT_EQ(rows, 7);
}

TEST(BrakedKicks, HaveTheClosedFormOfTheFloorWithoutLag) {
  for (const double step_N : {0.025, 0.5, 2.0}) {
    const double A = 2.5, B = 4.5, T = 1e-3, b = std::floor(0.9 * A / step_N) * step_N;
    const double kappa = least_share * (B + b) / (A + b);
    const double F = std::ceil((B + kappa * (B - A) / (1 - kappa)) / step_N) * step_N;
    const double expected = T * T * (F - A) * (F + b) / (2 * (A + b));
    EXPECT_NEAR(design_braked_kicks<double>(example(T, 0, step_N)).floor_m, expected, 0.01 * expected);
  }
}

template <class Real>
void expect_no_kick_beyond(const BrakedClass& c, double most_lost) {
  const auto design = design_braked_kicks<Real>(c);
  ASSERT_TRUE(design.possible());
  EXPECT_LE(design.aim_lost, most_lost);
  EXPECT_LE(design.table_bytes, sizeof(Real) == 4 ? 2150U : 4300U);
  std::mt19937_64 random{5};
  std::uniform_real_distribution<> share{0, 1};
  for (int i = 0; i < 3000; ++i) {
    const auto y = static_cast<Real>(design.floor_m * std::pow(design.reach_m / design.floor_m, share(random)));
    const law::Pulse<Real> p = design.kicks.table.pulse(y);
    const double step_N = c.force_step_N;
    const double force_N = std::floor(std::min(static_cast<double>(p.force_N), c.max_force_N) / step_N) * step_N;
    const auto distance_m = static_cast<double>(y);
    ASSERT_LE(most_travel_m(c, force_N, p.periods, p.cut_periods), distance_m) << distance_m;
    ASSERT_GE(least_travel_m(c, force_N, p.periods, p.cut_periods), least_share * distance_m) << distance_m;
  }
}

TEST(BrakedKicks, NeverAimBeyondAndAlwaysTakeTheirShare) {
  for (const double lag_s : {0.0, 1e-4, 1e-3, 5e-3}) {
    for (const double step_N : {0.025, 0.5, 5.0}) {
      BrakedClass c = example(1e-3, lag_s, step_N);
      expect_no_kick_beyond<float>(c, 2e-6);
      expect_no_kick_beyond<double>(c, 2e-6);
      c.mass_kg = {0.9, 1.1};
      c.force_gain = {0.95, 1.05};
      c.load_N = 0.3;
      c.lag_s = {0.8 * lag_s, 1.2 * lag_s};
      expect_no_kick_beyond<float>(c, 2e-6);
    }
  }
}

// The longest cuts of a slow loop take up to the 255 periods that a table can hold.
TEST(BrakedKicks, NeverAimBeyondBehindASlowCurrentLoop) {
  BrakedClass c = example(1e-3, 0.15, 0.8);
  c.max_force_N = 20;
  expect_no_kick_beyond<float>(c, 1);
}

TEST(BrakedKicks, ArePossibleBehindACurrentLoopOfAnySpeed) {
  for (const double lag_s : {0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4})
    EXPECT_TRUE(design_braked_kicks<float>(example(1e-3, lag_s)).possible()) << lag_s;
}

TEST(BrakedKicks, NeverAimBeyondWhereTheLoopJittersAndReadingsAreNoisy) {
  for (const double lag_s : {0.0, 1e-4, 2e-3}) {
    for (const double jitter_s : {1e-4, 5e-4}) {
      BrakedClass c = example(1e-3, lag_s, 0.025);
      c.jitter_s = jitter_s;
      c.encoder_noise_m = 1e-9;
      expect_no_kick_beyond<float>(c, 2e-6);
    }
  }
}

// The curve before it is rounded to steps of the drive is the ideal kick's as the period tends to 0: k3 of a coast that
// the brake and friction end, with hardly any feedback.
TEST(BrakedKicks, TendToK3) {
  const double y = 1e-3;
  const double k3_Ns = K3<double>::make({1, 1e-16, 1e-7, 2.5 + 2.25}).impulse_Ns(-y);
  const auto off = [&](double period_s) {
    BrakedClass c = example(period_s);
    c.max_force_N = 1e6;
    c.encoder_resolution_m = 1e-4;  // the table begins at half a count
    const law::Pulse<double> p = design_braked_kicks<double>(c).kicks.table.pulse(y);
    return p.force_N * p.periods * period_s / k3_Ns - 1;
  };
  EXPECT_LE(std::fabs(off(1e-6)), 4e-5);
  EXPECT_NEAR(off(1e-4) / off(1e-5), 10, 0.5);  // of first order, with the table's own 2e-7 in the lesser one
}

TEST(BrakedKicks, ScaleExactlyWithForceAndMass) {
  const auto reference = design_braked_kicks<double>(example(1e-3, 1e-3));
  for (const int k : {-12, -2, 2, 8}) {
    const double scale = std::ldexp(1, k);
    BrakedClass c = example(1e-3, 1e-3, 0.025 * scale);
    c.friction = {2.5 * scale, 4.5 * scale};
    c.max_force_N *= scale;
    c.encoder_resolution_m *= scale;
    const auto design = design_braked_kicks<double>(c);  // travels grow with the force, as the mass stays
    EXPECT_EQ(design.floor_m, reference.floor_m * scale);
    ASSERT_EQ(design.kicks.table.count, reference.kicks.table.count);
    for (std::size_t i = 0; i < design.kicks.table.count; ++i) {
      EXPECT_EQ(design.kicks.table.entries[i].a0, reference.kicks.table.entries[i].a0 * scale);
      EXPECT_EQ(design.kicks.table.periods[i], reference.kicks.table.periods[i]);
    }
  }
}

// The places of a table are those of single digits of the root of a distance in metres. Where they lie between two
// lengths of an axis must not show in what is certified of it.
TEST(BrakedKicks, HaveTheSameFloorInEveryUnitOfLength) {
  for (const double encoder_resolution_m : {1e-9, 1e-5}) {  // below the least pulse, and above it
    BrakedClass asked = example(1e-3, 2e-4, 0.05);
    asked.encoder_resolution_m = encoder_resolution_m;
    const double floor_m = design_braked_kicks<float>(asked).floor_m;
    for (double length = 1.1; length < 4; length *= 1.1) {
      BrakedClass c = asked;
      c.friction = {asked.friction.lower_N * length, asked.friction.upper_N * length};
      c.max_force_N *= length;
      c.force_step_N *= length;
      c.encoder_resolution_m *= length;
      EXPECT_NEAR(design_braked_kicks<float>(c).floor_m / length, floor_m, 1e-3 * floor_m) << length;
    }
  }
}

TEST(BrakedKicks, ArePossibleOnlyWherePulseAndBrakeAre) {
  EXPECT_TRUE(design_braked_kicks<float>(example()).possible());
  BrakedClass weak = example();
  weak.max_force_N = 4.5;
  EXPECT_FALSE(design_braked_kicks<float>(weak).breaks_away);
  BrakedClass loaded = example();
  loaded.load_N = 2.5;
  EXPECT_FALSE(design_braked_kicks<float>(loaded).brake_holds);
  BrakedClass coarse = example(1e-3, 0, 45);  // one force only, which moves the axis by far more than it must
  EXPECT_GT(design_braked_kicks<float>(coarse).floor_m, 1e-4);
  BrakedClass blind = example();
  blind.encoder_resolution_m = 1e9;
  EXPECT_FALSE(design_braked_kicks<float>(blind).rest_is_seen);
}

// What is left of an error by a kick from the worst of its readings, none of which is within the tolerance.
double worst_left_m(const BrakedClass& c, const BrakedDesign<float>& design, double error_m, double tolerance_m) {
  double left_m = 0;
  for (int i = 0; i <= 40; ++i) {
    const double reading_m = error_m + c.encoder_resolution_m * (i / 40.0 - 0.5);
    if (reading_m <= tolerance_m) continue;
    const law::Pulse<float> p = design.kicks.table.pulse(static_cast<float>(reading_m));
    const double steps = std::min(static_cast<double>(p.force_N), c.max_force_N) / c.force_step_N;
    const double force_N = std::floor(steps * (1 + 1e-9)) * c.force_step_N;
    left_m = std::max(left_m, error_m - least_travel_m(c, force_N, p.periods, p.cut_periods));
  }
  return left_m;
}

TEST(BrakedKicks, AreAsManyAsPromisedForWhoeverReadsAtHisWorst) {
  for (const double lag_s : {0.0, 1e-3, 5e-3}) {
    for (const double step_N : {0.025, 0.5, 5.0}) {
      for (const double count_m : {1e-6, 1e-5, 3e-5}) {
        for (const double share : {0.0, 0.1, 0.3}) {
          BrakedClass c = example(1e-3, 0, step_N);
          c.lag_s = {0.8 * lag_s, 1.2 * lag_s};
          c.mass_kg = {1 - share, 1 + share};
          c.encoder_resolution_m = count_m;
          const auto design = design_braked_kicks<float>(c);
          const double tolerance_m = design.least_tolerance_m;
          const int promised = most_kicks(c, design, design.reach_m, tolerance_m);
          if (promised == 0) continue;
          int kicks = 0;
          for (double error_m = design.reach_m; error_m + count_m / 2 > tolerance_m && kicks <= promised; ++kicks)
            error_m = worst_left_m(c, design, error_m, tolerance_m);
          EXPECT_LE(kicks, promised) << "lag " << lag_s << " s, step " << step_N << " N, count " << count_m
                                     << " m, mass off by " << share;
        }
      }
    }
  }
}

// Of readings that are whole counts, near the floor and up to the reach; of others where the target is so far from one.
void expect_sure_travel(const BrakedClass& c, double share_of_count = 0) {
  const auto design = design_braked_kicks<float>(c);
  ASSERT_TRUE(design.possible());
  const law::SureTravel<float>& sure = design.kicks.sure;
  const double q = c.encoder_resolution_m, first = std::ceil(design.floor_m / q * (1 - 1e-6));
  for (double count = first; count * q < 1.5 * design.reach_m;
       count = std::ceil(count * (count < 2000 ? 1 : 1.01) + 1)) {
    const auto y = static_cast<float>((count + share_of_count) * q);
    const law::Pulse<float> p = design.kicks.table.pulse(y);
    const double force_N = std::floor(std::min(static_cast<double>(p.force_N), c.max_force_N) / c.force_step_N + 1e-6);
    const double least_m = least_travel_m(c, force_N * c.force_step_N, p.periods, p.cut_periods);
    ASSERT_LE(static_cast<double>(sure.from(y)), least_m) << count + share_of_count << " counts";
  }
}

TEST(BrakedKicks, TravelAtLeastWhatIsSure) {
  int known = 0;
  for (const double lag_s : {0.0, 1e-4, 2e-3}) {
    for (const double step_N : {0.025, 0.5, 3.0}) {
      for (const double count_m : {1e-9, 1e-6, 7e-6, 1e-4}) {
        for (const double share : {0.0, 0.1}) {
          BrakedClass c = example(1e-3, 0, step_N);
          c.lag_s = {0.8 * lag_s, 1.2 * lag_s};
          c.mass_kg = {1 - share, 1 + share};
          c.force_gain = {1 - share / 2, 1 + share / 2};
          c.encoder_resolution_m = count_m;
          SCOPED_TRACE(::testing::Message() << "lag " << lag_s << " s, step " << step_N << " N, count " << count_m
                                            << " m, mass off by " << share);
          expect_sure_travel(c);
          if (design_braked_kicks<float>(c).kicks.sure.share > 0) ++known;
        }
      }
    }
  }
  EXPECT_GT(known, 36) << "of 72 classes";
}

// LinuxCNC does not round its targets to counts.
TEST(BrakedKicks, TravelAtLeastWhatIsSureFromPlacesBetweenCounts) {
  for (const double count_m : {1e-6, 7e-6, 3e-5}) {
    for (const double step_N : {0.025, 0.5, 1.5}) {
      BrakedClass c = example(1e-3, 2e-3, step_N);
      c.encoder_resolution_m = count_m;
      for (double share = 0.01; share < 1; share += 0.15) {
        SCOPED_TRACE(::testing::Message() << "step " << step_N << " N, count " << count_m << " m");
        expect_sure_travel(c, share);
      }
    }
  }
}

// Intervals end at powers of two of their unit, and where one ends a longer pulse may begin that is less sure.
TEST(BrakedKicks, TravelAtLeastWhatIsSureFromCountsWhereIntervalsEnd) {
  for (int power = 10; power <= 18; ++power) {
    BrakedClass c = example(1e-3, 0, 0.025);
    c.lag_s = {3.2e-3, 4.8e-3};
    c.encoder_resolution_m = std::ldexp(1.0, -power);
    SCOPED_TRACE(::testing::Message() << "count 2^-" << power << " m");
    expect_sure_travel(c);
  }
}

// The strongest pulse goes no further than the force of the drive and the longest pulse let it, however far away the
// axis is: that is seven counts here.
TEST(BrakedKicks, TravelAtLeastWhatIsSureAtTheEndOfTheirTable) {
  BrakedClass c = example(1e-3, 0, 0.2547);
  c.mass_kg = {7683.74, 7683.74};
  c.friction = {1.13103, 1.13216};
  c.max_force_N = 22.7247;
  c.encoder_resolution_m = 2.18345e-4;
  ASSERT_LT(design_braked_kicks<float>(c).reach_m, 8 * c.encoder_resolution_m);
  expect_sure_travel(c);
}

// An axis behind springs gives back what it took.
TEST(BrakedKicks, AreSureOfNothingWhereFrictionBends) {
  BrakedClass c = example();
  c.encoder_resolution_m = 1e-6;
  EXPECT_GT(design_braked_kicks<float>(c).kicks.sure.share, 0);
  c.presliding_stiffness_N_per_m = 1e6;
  EXPECT_EQ(design_braked_kicks<float>(c).kicks.sure.share, 0);
}

// There a kick from the first count goes further than that, and would be followed by one back.
TEST(BrakedKicks, LeaveNoToleranceBelowACountWhereFrictionBends) {
  BrakedClass c = example();
  c.encoder_resolution_m = 1e-3;
  EXPECT_LT(design_braked_kicks<float>(c).least_tolerance_m, c.encoder_resolution_m);
  c.presliding_stiffness_N_per_m = 1e6;
  EXPECT_GT(design_braked_kicks<float>(c).least_tolerance_m, c.encoder_resolution_m);
}

// The time of a kick is at least that of its periods, and grows with the distance.
TEST(BindingLimit, IsWhatTheLeastToleranceWouldBeLeastWithHalfOf) {
  BrakedClass coarse = example();
  coarse.encoder_resolution_m = 1e-3;
  for (const auto& [axes, name] :
       {std::pair{coarse, "the encoder"}, std::pair{example(1e-3, 0, 20), "the step of force"},
        std::pair{example(1e-3, 0.02), "the time constant of the current loop"},
        std::pair{example(), "the width of the friction bounds"}}) {
    const BindingLimit limit = binding_limit(axes);
    EXPECT_EQ(limit.name, name);
    EXPECT_LT(limit.least_tolerance_m, 0.7 * design_braked_kicks<float>(axes).least_tolerance_m) << name;
  }
}

TEST(KickPromise, BoundsTheTimeOfTheKicks) {
  const BrakedClass c = example(1e-3, 1e-3);
  const auto design = design_braked_kicks<float>(c);
  const KickPromise promise{c, design, design.least_tolerance_m};
  EXPECT_EQ(promise.most_s(design.least_tolerance_m / 2), 0);
  EXPECT_GT(promise.most_s(1e-3), 3e-3 * promise.most_kicks(1e-3));
  EXPECT_GT(promise.most_s(1e-2), promise.most_s(1e-3));
  EXPECT_TRUE(std::isinf(KickPromise(c, design, design.floor_m / 2).most_s(1e-3))) << "nothing is promised there";
}

TEST(KickPromise, OfAFineStageHasNothingToDoWithinItsTolerance) {
  BrakedClass c = example();
  c.encoder_resolution_m = 1e-7;
  c.fine_tolerance_m = 6e-7;
  const auto design = design_braked_kicks<float>(c);
  ASSERT_TRUE(design.has_fine_stage());
  const KickPromise promise{c, design, c.fine_tolerance_m};
  EXPECT_EQ(promise.reached_m(), design.least_tolerance_m);
  EXPECT_EQ(promise.most_kicks(5e-7), 0);
  EXPECT_EQ(promise.most_s(5e-7), 0);
  EXPECT_GT(promise.most_kicks(6e-7), 0) << "a reading of it may be outside";
}

// Far beyond its table a kick takes the same off every time.
TEST(KickPromise, CountsToAHundredThousandKicksAndNoFurther) {
  BrakedClass c = example();
  const auto design = design_braked_kicks<float>(c);
  const KickPromise promise{c, design, design.least_tolerance_m};
  EXPECT_GT(promise.most_kicks(100 * design.reach_m), 50);
  EXPECT_LT(promise.most_s(100 * design.reach_m), INFINITY);
  EXPECT_EQ(promise.most_kicks(1e6 * design.reach_m), 0);
  EXPECT_EQ(promise.most_s(1e6 * design.reach_m), INFINITY);
}

// So far away that what a kick takes off is lost in the rounding of the distance.
TEST(KickPromise, SeesNoEndFromBeyondAllMeasure) {
  BrakedClass c = example();
  c.encoder_resolution_m = 1e-7;
  for (const double fine_tolerance_m : {0.0, 6e-7}) {
    c.fine_tolerance_m = fine_tolerance_m;
    const auto design = design_braked_kicks<float>(c);
    ASSERT_EQ(design.has_fine_stage(), fine_tolerance_m > 0);
    const KickPromise promise{c, design, design.least_tolerance_m};
    EXPECT_GT(promise.most_kicks(1), 0);
    EXPECT_EQ(promise.most_kicks(1e30), 0);
    EXPECT_EQ(promise.most_s(1e30), INFINITY);
  }
}

TEST(BrakedKicks, HaveNoFineStageWhereTheyAreNotPossible) {
  BrakedClass c = example();
  c.encoder_resolution_m = 1e-6;
  c.fine_tolerance_m = 6e-7;
  EXPECT_TRUE(design_braked_kicks<float>(c).has_fine_stage());
  c.mass_kg = {0.01, 1};
  const auto design = design_braked_kicks<float>(c);
  EXPECT_FALSE(design.possible());
  EXPECT_FALSE(design.has_fine_stage());
}

TEST(BrakedKicks, NeedMoreKicksTheFurtherAndTheCloser) {
  const BrakedClass c = example();
  const auto design = design_braked_kicks<float>(c);
  EXPECT_EQ(most_kicks(c, design, design.floor_m / 2, design.floor_m), 0);
  const int near = most_kicks(c, design, 1e-4, design.floor_m), far = most_kicks(c, design, 1e-2, design.floor_m);
  EXPECT_GT(near, 0);
  EXPECT_GT(far, near);
  EXPECT_LE(most_kicks(c, design, 1e-2, 10 * design.floor_m), far);
  EXPECT_EQ(most_kicks(c, design, 1e-2, design.floor_m / 2), 0);  // promises nothing
}

}  // namespace
}  // namespace breakaway::design
