#include "breakaway/hybrid/budget.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "breakaway/input/input_error.hpp"

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
