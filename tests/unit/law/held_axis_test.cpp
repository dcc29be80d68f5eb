// What is sure of an axis while it is held.
#include "breakaway/law/held_axis.hpp"

#include <gtest/gtest.h>

#include "../../campaign/random_braked_axis.hpp"
#include "belt_fixture.hpp"
#include "law_fixture.hpp"

namespace breakaway::law {
namespace {

// One whose kicks are never looked at is held as every axis under the coast "pd" is: no spring bends it.
TEST(HeldAxis, UnderTheCoastPdIsAllowedTheStickSetAndWhatReadingsAreOff) {
  const auto p = testing::sampled_axis<float>();
  const WorkKicks<float> not_looked_at = design::design_work_kicks<float>(work_test::belt()).kicks;
  const K3Table<float> table = testing::ballistic_table(p, p.stick_radius_upper_m());
  const HeldAxis<float> held = AxisController<float, WorkKicks<float>>{p, table, not_looked_at}.held();
  EXPECT_EQ(held.allowed_m, p.stick_radius_upper_m() + seen_off_m(p));
  EXPECT_EQ(held.allowed_m, (AxisController<float>{p, table}.held().allowed_m));
  EXPECT_EQ(held.force_N, p.friction.lower_N / 2);
  EXPECT_FALSE(held.is_rigid);
  const HeldAxis<float> unkicked = AxisController<float>{p, table}.held();
  EXPECT_TRUE(unkicked.is_rigid);
  EXPECT_EQ(unkicked.force_N, p.friction.lower_N / 2) << "of the least friction half is sure";
}

TEST(HeldAxis, UnderTheBrakeStaysUnderItsHoldingForceAndIsAllowedAsFarAsKicksBegin) {
  design::BrakedClass axes = breakaway::testing::axes_of_the_scenes(1e-4);
  auto kicks = design::design_braked_kicks<float>(axes).kicks;
  const auto p = campaign::parameters(axes, 2.5e-6);
  const HeldAxis<float> rigid = held_axis(p, &kicks);
  EXPECT_EQ(rigid.force_N, kicks.holding_force_N);
  EXPECT_GT(rigid.force_N, kicks.brake_N);
  EXPECT_LT(rigid.force_N, 2.5F);
  EXPECT_FLOAT_EQ(rigid.allowed_m, kicks.begin_m() + p.position_tolerance_m + 2e-6F);
  EXPECT_TRUE(rigid.is_rigid);
  kicks.spring.reach_m = 5e-6F;
  kicks.spring.most_N = 2.45F;
  const HeldAxis<float> bent = held_axis(p, &kicks);
  EXPECT_EQ(bent.force_N, 2.45F) << "its bristles hold more than its brake presses with";
  EXPECT_NEAR(bent.allowed_m - rigid.allowed_m, 1e-5F, 1e-8F) << "it may be bent either way";
  const HeldAxis<float> unknown;
  EXPECT_EQ(unknown.force_N, 0);
  EXPECT_GT(unknown.allowed_m, 1e30F);
  EXPECT_TRUE(unknown.is_rigid);
}

TEST(HeldAxis, WithALoadOnASpringIsAllowedAsFarAsItsKicksBeginAndWhatItsSpringBends) {
  const auto kicks = design::design_work_kicks<float>(work_test::belt()).kicks;
  const auto p = work_test::parameters_of<float>(work_test::belt(), 1e-4);
  const HeldAxis<float> held =
      AxisController<float, WorkKicks<float>>{p, testing::ballistic_table(p, 1.0F), kicks}.held();
  EXPECT_FLOAT_EQ(held.allowed_m, kicks.begin_m() + seen_off_m(p) + 2 * (kicks.spring_m + kicks.creep_m));
  EXPECT_EQ(held.force_N, p.friction.lower_N / 2);
  EXPECT_FALSE(held.is_rigid);
}

}  // namespace
}  // namespace breakaway::law
