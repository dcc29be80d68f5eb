#include "breakaway/design/approach_time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../controller/design/src/planned_force.hpp"

namespace breakaway::design {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

BrakedClass class_with(double friction_lower_N, double friction_upper_N) {
  BrakedClass c;
  c.friction = {friction_lower_N, friction_upper_N};
  c.max_force_N = 50;
  c.force_step_N = 0.025;
  c.period_s = 1e-4;
  c.encoder_resolution_m = 1e-7;
  return c;
}

double time_s(const BrakedClass& c, double max_speed_m_s, double distance_m) {
  return approach_s(c, design_braked_kicks<float>(c), max_speed_m_s, distance_m);
}

// What it takes the slowest axis to come back from as far beyond the target as an approach may pass it, rather than
// from ten times where the brake takes over, at the speed of that.
double way_back_s(const BrakedClass& c, double max_speed_m_s) {
  const auto design = design_braked_kicks<float>(c);
  const auto& plan = design.kicks.approach;
  const double more_m = approach_beyond_m(c, design, max_speed_m_s) - 10 * hand_over_m(design);
  return more_m / (static_cast<double>(plan.switch_speed_m_s) - detail::slower_than_planned_m_s(c, plan));
}

// Of friction that hardly varies, far away: full force for half of the way, and 0.8 of it, less what friction adds, for
// the rest; and a constant speed where one is set.
TEST(ApproachTime, IsThatOfTheFastestMoveWhereNothingIsUnknown) {
  const BrakedClass c = class_with(3, 3.1);
  const double speeding = (50 - 3.1) / 1, braking = 0.8 * (50 + 3) / 1;
  for (const double distance_m : {0.1, 1.0, 10.0}) {
    const double bang_bang_s = std::sqrt(2 * distance_m * (1 / speeding + 1 / braking));
    EXPECT_GT(time_s(c, 1e3, distance_m), bang_bang_s);
    EXPECT_LT(time_s(c, 1e3, distance_m), 1.06 * bang_bang_s + 0.03 + way_back_s(c, 1e3));
    const double cruise_s = distance_m / 0.5 + 0.25 * (1 / speeding + 1 / braking);
    EXPECT_GT(time_s(c, 0.5, distance_m), cruise_s);
    EXPECT_LT(time_s(c, 0.5, distance_m), 1.06 * cruise_s + 0.03 + way_back_s(c, 0.5));
  }
}

TEST(ApproachTime, GrowsWithTheWayAndWithWhatIsUnknown) {
  const BrakedClass known = class_with(3, 3.1), unknown = class_with(2, 4.5);
  double before_s = 0;
  for (double distance_m = 1e-4; distance_m < 10; distance_m *= 1.5) {
    const double now_s = time_s(known, 10, distance_m);
    EXPECT_GE(now_s, before_s);
    EXPECT_GT(time_s(unknown, 10, distance_m), now_s);
    before_s = now_s;
  }
  BrakedClass heavier = known;
  heavier.mass_kg.most = 1.2;
  EXPECT_GT(time_s(heavier, 10, 1), time_s(known, 10, 1));
}

TEST(ApproachTime, IsInfiniteWhereTheSpeedMovesNoAxisOfTheClass) {
  const BrakedClass c = class_with(2, 4.5);
  const double least_m_s = least_approach_speed_m_s(c, design_braked_kicks<float>(c));
  EXPECT_EQ(time_s(c, 0.99 * least_m_s, 1), infinity);
  EXPECT_LT(time_s(c, 1.01 * least_m_s, 1), infinity);
}

// A target within the distance at which brake and kicks take over leaves no way for an approach.
TEST(ApproachTime, TakesNoTimeForAWayThatBrakeAndKicksGo) {
  const BrakedClass c = class_with(2, 4.5);
  const double hand_over = hand_over_m(design_braked_kicks<float>(c));
  const double nearest_s = time_s(c, 1, hand_over);
  EXPECT_GT(nearest_s, 0);
  EXPECT_DOUBLE_EQ(time_s(c, 1, hand_over / 2), nearest_s);
  EXPECT_DOUBLE_EQ(time_s(c, 1, 0), nearest_s);
  EXPECT_GT(time_s(c, 1, 2 * hand_over), nearest_s);
}

// The only force above the greatest friction is one step; half a step less, to which a plan may be rounded, is below
// it.
TEST(ApproachTime, IsInfiniteWhereRoundingToStepsMayLeaveNoForceToSpeedUpWith) {
  BrakedClass c;
  c.friction = {3, 5.9};
  c.max_force_N = 6, c.force_step_N = 2;
  c.period_s = 1e-4;
  c.encoder_resolution_m = 1e-7;
  c.move = MoveRequest{.distance_m = 1, .speed_m_s = 1e3, .acceleration_m_s2 = 50};
  const auto design = design_braked_kicks<float>(c);
  ASSERT_TRUE(design.kicks.approach.move.are_asked_for());
  ASSERT_LT(least_approach_speed_m_s(c, design), 1e3);
  EXPECT_EQ(approach_s(c, design, 1e3, 1), infinity);
}

}  // namespace
}  // namespace breakaway::design
