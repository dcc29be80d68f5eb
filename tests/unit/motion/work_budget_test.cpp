#include "breakaway/motion/work_budget.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "../refusal.hpp"
#include "breakaway/model/shapes.hpp"
#include "breakaway/motion/compliant_axis.hpp"
#include "breakaway/motion/slide.hpp"

namespace breakaway::motion {
namespace {

using model::CompliantPlant;
using model::FrictionLaw;
using testing::refusal;

WorkBudget budget_for(const WorkBudget::Run& run) { return {run, "the axis", "the cause", "the remedy"}; }

// The share of the work that a run of one second spends in even steps before it ends or is refused.
double share_spent(bool may_end, double work_of_the_run) {
  WorkBudget budget = budget_for({.duration_s = 1, .may_end = may_end});
  constexpr int steps = 10'000;
  try {
    for (int i = 1; i <= steps; ++i) budget.spend(static_cast<double>(i) / steps, work_of_the_run / steps);
  } catch (const OverBudget&) {
  }
  return budget.share();
}

TEST(WorkBudget, LetsARunPassThatCostsNoMore) {
  EXPECT_NEAR(share_spent(false, 0.99 * WorkBudget::usual_work), 0.99, 1e-9);
  EXPECT_NEAR(share_spent(true, 0.99 * WorkBudget::usual_work), 0.99, 1e-9);
}

TEST(WorkBudget, GivesUpSoonWhatWouldCostManyTimesAsMuch) {
  EXPECT_LT(share_spent(false, 100 * WorkBudget::usual_work), 0.15);
  EXPECT_LT(share_spent(false, 4 * WorkBudget::usual_work), 0.3);
  // A run that may come to rest at any time is given all.
  EXPECT_NEAR(share_spent(true, 100 * WorkBudget::usual_work), 1, 0.02);
}

TEST(WorkBudget, GrowsWithThePeriodsOfTheRun) {
  WorkBudget one = budget_for({.duration_s = 1}), many = budget_for({.duration_s = 1, .periods = 1e5});
  EXPECT_EQ(many.left() - one.left(), 1e5 * WorkBudget::work_of_a_period);
}

TEST(WorkBudget, RefusesInOneLineWithCauseCostAndRemedy) {
  WorkBudget budget = budget_for({.duration_s = 10});
  EXPECT_EQ(refusal([&] { budget.spend(0.1, 2 * WorkBudget::usual_work); }),
            "following the axis for 10 s would take about 6e+09 evaluations of its forces, and a run may take 3e+07 "
            "(the cause): the remedy");
  EXPECT_NE(refusal([&] { budget.spend(0, 1); }).find("more than 6e+07"), std::string::npos);
}

// All that may go on without end: friction that changes fast in time, at rest and in motion, or from place to place.
TEST(WorkBudget, EndsEveryMotionOfASlide) {
  const auto sine = [] { return model::shape::sine_in_time(1e9, 0); };
  const auto dwell = [] { return model::shape::random_dwell({.shortest_dwell_s = 1e-9, .longest_dwell_s = 1e-9}); };
  const auto follow = [](model::ShapePtr shape, double force_N) {
    WorkBudget budget = budget_for({.duration_s = 1, .work = 1e5});
    Slide slide{1, FrictionLaw{{2.5, 4.5}, std::move(shape)}, {}};
    slide.limit_work(&budget);
    return refusal([&] { slide.advance_to(1, {.constant_N = force_N}); });
  };
  EXPECT_NE(follow(sine(), 2.4999).find("following the axis"), std::string::npos);
  EXPECT_NE(follow(sine(), 5).find("following the axis"), std::string::npos);
  EXPECT_NE(follow(dwell(), 5).find("following the axis"), std::string::npos);
  EXPECT_NE(follow(model::shape::sine_in_position(1e-8, 0), 20).find("following the axis"), std::string::npos);
  EXPECT_EQ(follow(model::shape::sine_in_position(1e-2, 0), 20), "");
}

TEST(WorkBudget, EndsEveryMotionOfACompliantAxis) {
  const auto follow = [](const model::CompliantPlant& plant, double angular_frequency_rad_s) {
    WorkBudget budget = budget_for({.duration_s = 1, .work = 1e5});
    CompliantAxis axis{plant, {{2.5, 4.5}, model::shape::sine_in_time(angular_frequency_rad_s, 0)}, {0, 0, 10}};
    axis.limit_work(&budget);
    return refusal([&] { axis.advance_to(1, {.constant_N = 3}); });
  };
  CompliantPlant bristles, cogged, plain;
  bristles.presliding = model::Presliding{1e7, 0};
  cogged.cogging = {.amplitude = 1, .period_m = 1e-9};
  EXPECT_NE(follow(bristles, 1e9).find("following the axis"), std::string::npos);
  EXPECT_NE(follow(cogged, 1).find("following the axis"), std::string::npos);
  EXPECT_NE(follow(plain, 1e9).find("following the axis"), std::string::npos);
  EXPECT_EQ(follow(bristles, 1), "");
}

}  // namespace
}  // namespace breakaway::motion
