#include "breakaway/hybrid/budget.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "breakaway/input/input_error.hpp"

namespace budget_test {
namespace {

using breakaway::InputError;
using breakaway::hybrid::Budget;

std::string refusal(const Budget& budget, double done_s, double asked_s) {
  try {
    budget.refuse(done_s, asked_s, "the cause", "the remedy");
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Budget, IsExhaustedByWorkAndNotBySteps) {
  Budget budget(100);
  budget.spend(60);
  EXPECT_FALSE(budget.exhausted());
  EXPECT_EQ(budget.share(), 0.6);
  budget.spend(60);
  EXPECT_TRUE(budget.exhausted());
  EXPECT_EQ(budget.steps(), 2);
}

double no_friction(double) { return 0; }

// How much of its work a run spends that passes `pace_s(share)` of the `end_s` it was asked for with each unit of work,
// while friction takes `power(share)`.
template <class Pace, class Power = double (*)(double)>
double share_spent(double end_s, double slow_s, const Pace& pace_s, const Power& power = no_friction) {
  constexpr double work = 6400;
  Budget budget(work);
  for (double left_s = end_s; left_s > 0 && !budget.exhausted();) {
    budget.spend(1);
    left_s -= pace_s(budget.share());
    budget.rub(power(budget.share()) * pace_s(budget.share()));
    if (budget.judgement_due()) budget.judge(left_s, std::min(slow_s, left_s));
  }
  return budget.share();
}

TEST(Budget, GivesUpSoonWhatWouldCostFarMoreThanItHas) {
  const double never = std::numeric_limits<double>::infinity();
  const auto even = [](double) { return 1.0; };
  EXPECT_LT(share_spent(1e6, never, even), 0.13);
  EXPECT_LT(share_spent(4 * 6400, never, even), 0.3);
  // What needs no more than its work, or hardly more, is followed to the end.
  EXPECT_NEAR(share_spent(6000, never, even), 6000.0 / 6400, 1e-3);
  EXPECT_GT(share_spent(1.9 * 6400, never, even), 0.99);
  EXPECT_GT(share_spent(never, never, even), 0.99);
}

TEST(Budget, FollowsASlowStartToItsEnd) {
  const double never = std::numeric_limits<double>::infinity();
  // The pace rises two and a half times with each 64th of the work.
  EXPECT_LT(share_spent(1e9, never, [](double share) { return std::pow(2.5, 64 * share); }), 0.5);
  // Vibrations that are known to die soon are waited for,
  EXPECT_GT(share_spent(1e6, 0.1 * 6400, [](double) { return 1.0; }), 0.99);
  // and those that friction ends within the work, whose power falls evenly to nothing.
  const auto even = [](double) { return 1.0; };
  EXPECT_GT(share_spent(1e6, never, even, [](double share) { return 1.1 - share; }), 0.99);
  EXPECT_LT(share_spent(1e6, never, even, [](double share) { return 20 - share; }), 0.3);
}

TEST(Budget, RefusesWithTheCostOfTheWholeRun) {
  Budget budget(100);
  for (int step = 0; step < 50; ++step) budget.spend(10);
  EXPECT_EQ(refusal(budget, 0.5, 30),
            "following this machine for 30 s would take about 3000 steps (the cause): the remedy");
}

TEST(Budget, RefusesWithAKnownCostWhereThereIsNoProgressOrNoEnd) {
  Budget budget(100);
  budget.spend(101);
  EXPECT_NE(refusal(budget, 0, 30).find("for 30 s would take more than 1 steps"), std::string::npos);
  const double never = std::numeric_limits<double>::infinity();
  EXPECT_NE(refusal(budget, 1, never).find("to its rest would take more than 1 steps"), std::string::npos);
}

}  // namespace
}  // namespace budget_test
