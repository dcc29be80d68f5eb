// Axes whose friction bends before it slides, under the coast "brake" with the stiffness in the file: bristles of Dahl
// and LuGre under every kind of friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "../bristled_axis.hpp"
#include "certified_axis.hpp"
#include "random_braked_axis.hpp"

namespace breakaway::campaign {
namespace {

using testing::BristledSlider;
using testing::Bristles;
using testing::RunEnd;

struct Tally {
  long runs = 0, most_kicks = 0;
  double worst_m = 0, beyond = 0, time = 0;

  void add(const RunEnd& end, double bend_m) {
    ++runs;
    most_kicks = std::max<long>(most_kicks, end.kicks);
    worst_m = std::max(worst_m, std::fabs(end.error_m));
    beyond = std::max(beyond, end.beyond_m / bend_m);
  }
};

constexpr double asked_m = 0.7e-6;

// What is told of the bristles, and how stiff they are.
struct Told {
  double share;  // of the stiffness
  std::vector<double> stiffness_N_per_m{1e5, 3e5, 1e6, 1e7};
  bool fine_stage = false;
};

// The axis of the scenes on bristles. Returns how the runs ended; `check` judges each of them.
template <class Check>
Tally axis_of_the_scenes(const Told& told, long starts, const Check& check) {
  Tally tally;
  for (const double stiffness : told.stiffness_N_per_m) {
    BrakedClass c = testing::axes_of_the_scenes(0);
    c.presliding_stiffness_N_per_m = told.share * stiffness;
    if (told.fine_stage) c.fine_tolerance_m = asked_m;
    const auto kicks = design::design_braked_kicks<float>(c).kicks;
    const law::K3Table<float> unused;
    for (long i = 0; i < starts * kinds; ++i) {
      Random r{static_cast<std::uint64_t>(i) + 7'000'000};
      const int kind = static_cast<int>(i % kinds);
      const Bristles bristles{stiffness, i / kinds % 2 == 0 ? 0.0 : 2 * std::sqrt(stiffness)};
      const double start_m = r.decades(1e-4, 1e-1) * (r.share() < 0.5 ? 1 : -1);
      const Friction friction = friction_of_kind(kind, c, static_cast<std::uint64_t>(i), 1e-5, asked_m);
      const RunEnd end = testing::run_axis<float>(parameters(c, asked_m), unused, kicks,
                                                  BristledSlider{testing::TrueAxis{}, bristles, friction, start_m, 0},
                                                  1, 1000, 4, 200, r.between(-0.5, 0.5));
      tally.add(end, c.friction.upper_N / stiffness);
      check(end, std::to_string(stiffness) + " N/m, run " + std::to_string(i));
    }
  }
  std::printf("told %.2f of the stiffness: %ld runs, error at most %.2f um, at most %ld kicks\n", told.share,
              tally.runs, 1e6 * tally.worst_m, tally.most_kicks);
  return tally;
}

TEST(PreslidingCampaign, EveryRunEndsWithinTwelveTenthsOfACount) {
  axis_of_the_scenes({1}, asked_for("BREAKAWAY_BRISTLE_STARTS", 2), [](const RunEnd& end, const std::string& where) {
    EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault);
    EXPECT_LE(std::fabs(end.error_m), 1.2e-6) << where;
  });
}

TEST(PreslidingCampaign, EveryRunSettlesWhereTheBristlesAreThreeTimesStifferThanTold) {
  axis_of_the_scenes({1.0 / 3}, asked_for("BREAKAWAY_BRISTLE_STARTS", 2),
                     [](const RunEnd& end, const std::string& where) {
                       EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault);
                     });
}

TEST(PreslidingCampaign, EveryRunEndsInHoldOrInANameWhereTheBristlesAreThreeTimesSofterThanTold) {
  // Run 32 at 1e5 N/m took more, kicked by the spring stage.
  axis_of_the_scenes({3}, asked_for("BREAKAWAY_BRISTLE_STARTS", 3), [](const RunEnd& end, const std::string& where) {
    EXPECT_TRUE(end.held || end.ends_by_name()) << where << ": error " << end.error_m;
    EXPECT_LE(end.kicks, law::KickJudge<float>::most_kicks) << where;
  });
}

// Where bristles bend by less than the kicks can place the axis, they alone do not end it.
const std::vector<double> up_to_stiff{1e5, 3e5, 1e6, 1e7, 1e8};

TEST(PreslidingCampaign, EveryRunOnBristlesOfAnyStiffnessEndsWithinTwelveTenthsOfACountWithTheFineStage) {
  axis_of_the_scenes({1, up_to_stiff, true}, asked_for("BREAKAWAY_BRISTLE_STARTS", 2),
                     [](const RunEnd& end, const std::string& where) {
                       EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault);
                       EXPECT_LE(std::fabs(end.error_m), 1.2e-6) << where;
                     });
}

TEST(PreslidingCampaign, EveryRunSettlesWithTheFineStageWhereTheBristlesAreThreeTimesStifferThanTold) {
  axis_of_the_scenes({1.0 / 3, up_to_stiff, true}, asked_for("BREAKAWAY_BRISTLE_STARTS", 2),
                     [](const RunEnd& end, const std::string& where) {
                       EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault);
                     });
}

// A random axis inside what is certified where friction bends, and bristles at least as stiff.
BrakedClass random_bending_axes(Random& r) {
  BrakedClass c = random_axes(r);
  const double T = c.period_s;
  c.encoder_noise_m = c.jitter_s = 0;
  if (c.lag_s.most > 0.2 * T) c.lag_s = {c.lag_s.least / c.lag_s.most * 0.2 * T, 0.2 * T};
  c.friction.lower_N = std::min(c.friction.lower_N, c.friction.upper_N / 1.6);
  if (c.max_force_N < 65 * c.force_step_N) c.force_step_N = c.max_force_N / 400;
  c.load_N = std::min(c.load_N, 0.1 * c.friction.lower_N);
  const double least_N = c.friction.lower_N - c.load_N;
  const double most_bend_m = std::min(30 * c.encoder_resolution_m, least_N * T * T / (0.0625 * c.mass_kg.most));
  c.presliding_stiffness_N_per_m = least_N / (most_bend_m * r.decades(0.01, 1));
  return c;
}

// As it is run: an approach may go no faster than that, which is too slow for some.
design::DesignReport report_at_usual_speed(const BrakedClass& c, double tolerance_m) {
  design::AxisDesign asked = asked_of(c, tolerance_m);
  asked.max_approach_speed_m_s = static_cast<double>(parameters(c, tolerance_m).max_approach_speed_m_s);
  return design::design_axis(asked);
}

struct BendingAxis {
  BrakedClass axes;
  design::BrakedDesign<float> design;
  double tolerance_m;
  design::DesignReport report;
};

// The axis of a number, with a random tolerance; nothing where no kicks are possible.
std::optional<BendingAxis> bending_axis(Random& r) {
  const BrakedClass c = random_bending_axes(r);
  const auto design = design::design_braked_kicks<float>(c);
  if (!design.possible()) return {};
  const double tolerance_m = design.least_tolerance_m * (r.share() < 0.5 ? 1.001 : r.between(1.001, 4));
  return BendingAxis{c, design, tolerance_m, report_at_usual_speed(c, tolerance_m)};
}

void run(long number, const BendingAxis& axis, Random& r, Tally& tally) {
  const auto& [c, design, tolerance_m, report] = axis;
  const design::BrakedPromise promise = *report.braked;
  const law::K3Table<float> unused;
  for (int kind = 0; kind < kinds; ++kind) {
    const testing::TrueAxis truth{r.inside(c.mass_kg), r.inside(c.force_gain), r.inside(c.lag_s),
                                  r.inside({-c.load_N, c.load_N}), c.latency_periods};
    const double start_m = std::min(design.floor_m * std::pow(10, 4 * r.share()), 1.0) * (r.share() < 0.5 ? 1 : -1);
    const Friction friction = friction_of_kind(kind, c, static_cast<std::uint64_t>(number * kinds + kind),
                                               std::max(3 * design.floor_m, c.encoder_resolution_m), tolerance_m);
    const double stiffness = c.presliding_stiffness_N_per_m * (r.share() < 0.4 ? 1 : r.decades(1, 30));
    const double share = r.share() < 0.4 ? 0 : r.share();  // of critical damping
    const Bristles bristles{stiffness, share * 2 * std::sqrt(stiffness * truth.mass_kg),
                            1e-4 * c.friction.lower_N * c.period_s / c.mass_kg.most};
    const law::BrakedKicks<float>& k = design.kicks;
    const double longest_s =
        130 * c.period_s * (2 * k.patient_periods + k.spring.longest_periods + k.spring.ringing_periods + 1500);
    const RunEnd end = testing::run_axis<float>(parameters(c, tolerance_m), unused, k,
                                                BristledSlider{truth, bristles, friction, start_m, 0},
                                                c.latency_periods, longest_s, 4, 100, r.between(-0.5, 0.5));
    tally.add(end, promise.beyond_m);
    const std::string where = "axis " + std::to_string(number) + ", friction " + std::to_string(kind);
    EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault) << ", error " << end.error_m;
    EXPECT_LE(end.held_error_m, promise.error_m * (1 + 1e-6)) << where;
    EXPECT_FALSE(end.moving_in_hold) << where;
    EXPECT_LE(end.kicks, promise.most_kicks) << where;
    const double kicks_s = end.kicks > 0 ? end.time_s - end.first_kick_s : 0;
    EXPECT_LE(kicks_s, promise.kicks_s) << where;
    tally.time = std::max(tally.time, kicks_s / promise.kicks_s);
    EXPECT_LE(end.beyond_m, promise.beyond_m * (1 + 1e-6)) << where;
  }
}

TEST(PreslidingCampaign, EveryCertifiedAxisKeepsItsPromise) {
  const long first = asked_for("BREAKAWAY_FIRST_AXIS", 0), axes = asked_for("BREAKAWAY_BENDING_AXES", 30);
  Tally tally;
  long certified = 0;
  for (long number = first; number < first + axes; ++number) {
    Random r{static_cast<std::uint64_t>(number)};
    const auto axis = bending_axis(r);
    if (!axis || !axis->report.certified) continue;
    ++certified;
    run(number, *axis, r, tally);
  }
  std::printf(
      "%ld of %ld axes certified, %ld runs, at most %ld kicks, at most %.2f of what may be beyond and %.2f of the "
      "time\n",
      certified, axes, tally.runs, tally.most_kicks, tally.beyond, tally.time);
  EXPECT_GE(certified, axes / 2);
}

// They were certified, and ended as hunting or diverging: the first two were kicked to and fro, the third back where it
// came from by a load, as it rang.
TEST(PreslidingCampaign, RefusesAxesWhoseKicksDoNotLeadOnByName) {
  struct Refused {
    std::uint64_t number;
    std::string check;
  };
  for (const Refused& refused : {Refused{602, "bent_kicks_end_nearer"}, Refused{674, "bent_kicks_end_nearer"},
                                 Refused{942, "bent_kicks_lead_on"}}) {
    Random r{refused.number};
    const auto axis = bending_axis(r);
    ASSERT_TRUE(axis);
    const auto check = std::ranges::find(axis->report.checks, refused.check, &design::Check::name);
    ASSERT_NE(check, axis->report.checks.end()) << refused.number;
    EXPECT_FALSE(check->holds) << refused.number;
    EXPECT_FALSE(axis->report.certified) << refused.number;
  }
}

// Grams under hundreds of newtons, read once in two milliseconds: they would have to be allowed some hundred metres a
// second, and ended as "drifting", or metres away, where they were run all the same.
TEST(PreslidingCampaign, AsksNothingOfAxesThatMayNotGoFastEnough) {
  for (const std::uint64_t number : {117U, 157U, 184U}) {
    Random r{number};
    const auto axis = bending_axis(r);
    ASSERT_TRUE(axis);
    EXPECT_FALSE(axis->report.certified) << number;
  }
}

}  // namespace
}  // namespace breakaway::campaign
