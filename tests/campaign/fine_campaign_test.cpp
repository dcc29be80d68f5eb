// Axes under the coast "brake" that are asked for less than their floor: the kicks of the fine stage, under every kind
// of friction.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "breakaway/law/kick_judge.hpp"
#include "certified_axis.hpp"
#include "random_braked_axis.hpp"

namespace breakaway::campaign {
namespace {

using testing::RunEnd;

// The class with the fine stage, and what its certificate promises of it.
struct FineAxes {
  BrakedClass axes;
  double tolerance_m;
  design::BrakedDesign<float> design;
  design::DesignReport report;

  FineAxes(BrakedClass c, double asked_m)
      : axes{with_fine_stage(std::move(c), asked_m)},
        tolerance_m{asked_m},
        design{design::design_braked_kicks<float>(axes)},
        report{design::design_axis(asked())} {}

  static BrakedClass with_fine_stage(BrakedClass c, double asked_m) {
    c.fine_tolerance_m = asked_m;
    return c;
  }
  // The fine stage may fall short of its tolerance by whatever the floor is.
  design::AxisDesign asked() const {
    design::AxisDesign axis = asked_of(axes, tolerance_m);
    axis.settle_tolerance_m = 1;
    return axis;
  }
};

struct Tally {
  long runs = 0, most_kicks = 0;
  double beyond = 0, longest = 0;  // as shares of what is promised
  std::vector<double> errors;      // as shares of the floor

  void note(const RunEnd& end, const FineAxes& fine) {
    ++runs;
    most_kicks = std::max<long>(most_kicks, end.kicks);
    beyond = std::max(beyond, end.beyond_m / fine.report.braked->beyond_m);
    if (end.kicks > 0) longest = std::max(longest, (end.time_s - end.first_kick_s) / fine.report.braked->kicks_s);
    errors.push_back(std::fabs(end.error_m) / fine.design.floor_m);
  }
  double error(double share) {
    const auto place = errors.begin() + std::lround(share * static_cast<double>(errors.size() - 1));
    std::nth_element(errors.begin(), place, errors.end());
    return *place;
  }
};

void expect_kept(const RunEnd& end, const FineAxes& fine, const std::string& where) {
  const design::BrakedPromise& promise = *fine.report.braked;
  const double lost_s = static_cast<double>(end.lost_samples) * fine.axes.period_s;
  EXPECT_TRUE(end.held) << where << ": " << to_string(end.fault) << ", " << end.kicks << " kicks, error "
                        << end.error_m;
  EXPECT_FALSE(end.moving_in_hold) << where;
  EXPECT_LE(std::fabs(end.error_m), promise.error_m * (1 + 1e-6)) << where;
  EXPECT_LE(end.beyond_m, promise.beyond_m * (1 + 1e-6)) << where;
  EXPECT_LE(end.kicks, promise.most_kicks) << where;
  EXPECT_LE(end.kicks > 0 ? end.time_s - end.first_kick_s : 0, promise.kicks_s + lost_s) << where;
}

void run(long number, const FineAxes& fine, Random& r, Tally& tally) {
  const BrakedClass& c = fine.axes;
  const law::K3Table<float> unused;
  for (int kind = 0; kind < kinds; ++kind) {
    const testing::TrueAxis truth{r.inside(c.mass_kg), r.inside(c.force_gain), r.inside(c.lag_s),
                                  r.inside({-c.load_N, c.load_N}), c.latency_periods};
    const double start_m = std::min(fine.design.floor_m * r.decades(0.3, 300), 1.0) * (r.share() < 0.5 ? 1 : -1);
    const double surplus_N = c.force_gain.least * c.max_force_N - c.friction.upper_N - c.load_N;
    const double longest_s =
        20 + 2 * fine.report.braked->kicks_s + 20 * std::sqrt(2 * std::fabs(start_m) * c.mass_kg.most / surplus_N);
    const Friction friction =
        friction_of_kind(kind, c, static_cast<std::uint64_t>(number * kinds + kind),
                         std::max(3 * fine.design.floor_m, c.encoder_resolution_m), fine.tolerance_m);
    // The target is a count. Where the tolerance is less than one, the places of the counts matter.
    const double encoder_offset = fine.tolerance_m < c.encoder_resolution_m ? 0 : r.between(-0.5, 0.5);
    const RunEnd end =
        testing::run_kicked_axis<float>(parameters(c, fine.tolerance_m), unused, fine.design.kicks, truth, friction,
                                        start_m, 0, longest_s, 4, 50, encoder_offset, {}, disturbance(c, r));
    tally.note(end, fine);
    expect_kept(end, fine, "axis " + std::to_string(number) + ", friction " + std::to_string(kind));
  }
}

// A random axis whose encoder sees less than its floor, and a tolerance between the two; nothing where there is none.
std::optional<FineAxes> random_fine_axes(Random& r) {
  BrakedClass c = random_axes(r);
  const auto coarse = design::design_braked_kicks<float>(c);
  if (!coarse.possible()) return {};
  const double finer = std::min(1.0, coarse.floor_m / r.decades(3, 1000) / c.encoder_resolution_m);
  c.encoder_resolution_m *= finer;
  c.encoder_noise_m *= finer;
  const auto by_table = design::design_braked_kicks<float>(c);
  const double least_m = 1.001 * by_table.least_reading_m, most_m = 0.99 * by_table.floor_m;
  if (!by_table.possible() || by_table.kicks.table.list || !(least_m < most_m)) return {};
  return FineAxes{c, r.decades(least_m, most_m)};
}

TEST(FineCampaign, EveryCertifiedAxisKeepsItsPromise) {
  const long first = asked_for("BREAKAWAY_FIRST_AXIS", 0), axes = asked_for("BREAKAWAY_FINE_AXES", 20);
  Tally tally;
  long certified = 0, below = 0;
  for (long number = first; number < first + axes; ++number) {
    Random r{static_cast<std::uint64_t>(number) + 9'000'000};
    const auto fine = random_fine_axes(r);
    if (!fine) continue;
    ++below;
    if (!fine->report.certified) continue;
    ++certified;
    run(number, *fine, r, tally);
  }
  std::printf("%ld of %ld axes certified, %ld runs, at most %ld kicks, %.3f of what may be beyond, %.3f of the time\n",
              certified, below, tally.runs, tally.most_kicks, tally.beyond, tally.longest);
  std::printf("error at rest: median %.4f floors, nine of ten %.4f, worst %.4f\n", tally.error(0.5), tally.error(0.9),
              tally.error(1));
  EXPECT_GE(certified, below / 2);
  EXPECT_LE(tally.error(0.5), 0.25);
}

TEST(FineCampaign, EveryRunOfAnAxisToldWrongEndsInHoldOrInAName) {
  constexpr int most_kicks = law::KickJudge<float>::most_kicks;
  const law::K3Table<float> unused;
  long runs = 0, held = 0, kicks = 0;
  for (long number = 0; number < asked_for("BREAKAWAY_TOLD_WRONG", 16); ++number) {
    Random r{static_cast<std::uint64_t>(number) + 11'000'000};
    const auto fine = random_fine_axes(r);
    if (!fine) continue;
    const Wrong truth{fine->axes, r};
    BrakedClass true_class = fine->axes;
    true_class.friction = truth.friction;
    const int kind = static_cast<int>(kinds * r.share());
    const Friction friction = friction_of_kind(kind, true_class, static_cast<std::uint64_t>(number),
                                               3 * fine->design.floor_m, fine->tolerance_m);
    const double start_m = std::min(fine->design.floor_m * r.decades(0.3, 300), 1.0) * (r.share() < 0.5 ? 1 : -1);
    const double longest_s = 300 * fine->axes.period_s * (2 * fine->design.kicks.patient_periods + 1500) + 100;
    const RunEnd end =
        testing::run_kicked_axis<float>(parameters(fine->axes, fine->tolerance_m), unused, fine->design.kicks,
                                        truth.axis, friction, start_m, 0, longest_s, 4, 50, r.between(-0.5, 0.5));
    ++runs;
    held += end.held ? 1 : 0;
    kicks = std::max<long>(kicks, end.kicks);
    EXPECT_TRUE(end.held || end.ends_by_name())
        << "run " << number << ", friction " << kind << ": error " << end.error_m << " after " << end.kicks << " kicks";
    EXPECT_LE(end.kicks, most_kicks) << "run " << number << ", friction " << kind << ": " << to_string(end.fault);
  }
  std::printf("told wrong: %ld of %ld runs held, the others by name, at most %ld kicks\n", held, runs, kicks);
}

TEST(FineCampaign, EndsAFiftiethOfTheFloorAwayAtFourMilliseconds) {
  BrakedClass c = testing::axes_of_the_scenes(0);
  c.period_s = 4e-3;
  const FineAxes fine{c, 0.6e-6};
  ASSERT_TRUE(fine.report.certified) << fine.report.reasons.front();
  const law::K3Table<float> unused;
  Tally tally;
  for (long i = 0; i < asked_for("BREAKAWAY_FINE_STARTS", 20) * kinds; ++i) {
    Random r{static_cast<std::uint64_t>(i)};
    const Friction friction = friction_of_kind(static_cast<int>(i % kinds), c, static_cast<std::uint64_t>(i),
                                               3 * fine.design.floor_m, fine.tolerance_m);
    const double start_m = r.decades(1e-5, 1e-1) * (r.share() < 0.5 ? 1 : -1);
    const RunEnd end = testing::run_kicked_axis<float>(parameters(c, fine.tolerance_m), unused, fine.design.kicks, {},
                                                       friction, start_m, 0, 60, 8, 200, r.between(-0.5, 0.5));
    tally.note(end, fine);
    expect_kept(end, fine, "run " + std::to_string(i));
  }
  const double to_um = 1e6 * fine.design.floor_m;
  std::printf("floor %.1f um, %ld runs: error median %.2f um, nine of ten %.2f um, worst %.1f um, at most %ld kicks\n",
              to_um, tally.runs, to_um * tally.error(0.5), to_um * tally.error(0.9), to_um * tally.error(1),
              tally.most_kicks);
  EXPECT_LE(to_um * tally.error(0.5), 0.5);
}

}  // namespace
}  // namespace breakaway::campaign
