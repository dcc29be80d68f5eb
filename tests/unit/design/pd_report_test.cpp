// What a report says of the coast "pd": what is tried in closed loop, and what is offered where a check fails.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "check_of.hpp"
#include "example_axes.hpp"

namespace {

using namespace breakaway::design;
using breakaway::testing::check_of;
using breakaway::testing::impulsive_example;

// An approach without damping swings to and fro until friction has taken all its energy, for hours where it takes
// little. What was seen of it until it is given up is no promise.
TEST(DesignReport, RefusesAnAxisUnderTheCoastPdThatIsTriedForTooShortATime) {
  AxisDesign axis = impulsive_example();
  axis.friction = {2.5e-3, 4.5e-3};
  axis.encoder_resolution_m = 1e-9;
  axis.approach_damping_Ns_per_m = 1e-6;
  axis.max_approach_speed_m_s = 1e6;
  axis.longest_way_m = 1;
  const DesignReport tried = design_axis(axis);
  EXPECT_TRUE(tried.certified) << tried.reasons.front();
  axis.longest_way_m = 100;
  const DesignReport report = design_axis(axis);
  EXPECT_FALSE(report.certified);
  ASSERT_EQ(report.reasons.size(), 1U) << report.reasons.back();
  EXPECT_EQ(report.reasons[0],
            "axis_is_tried: trials of its approach and its kicks do not end within 20000000 periods; take a longer "
            "period, or coast = \"brake\"");
}

// A position error of 100 km is a float that is rounded by some millimetres, which the axis does not come on by within
// the patience of the law.
TEST(DesignReport, RefusesAnAxisUnderTheCoastPdThatAFloatDoesNotShowSettingOff) {
  AxisDesign axis = impulsive_example();
  axis.max_approach_speed_m_s = 1e6;
  axis.longest_way_m = 1e3;
  const DesignReport seen = design_axis(axis);
  EXPECT_TRUE(seen.certified) << seen.reasons.front();
  axis.longest_way_m = 1e5;
  const DesignReport report = design_axis(axis);
  ASSERT_EQ(report.reasons.size(), 1U);
  EXPECT_EQ(report.reasons[0].find("approach_ends_near: "), 0U) << report.reasons[0];
}

// Friction that falls with speed pushes an axis that moves.
TEST(DesignReport, SaysFromWhereAnApproachWithoutDampingComesToRest) {
  struct Case {
    double slope_Ns_per_m;
    const char* said;
  };
  for (const Case& c :
       {Case{-0.4, ": the approach comes to rest from everywhere"},
        Case{-0.6, "so the approach comes to rest from within "},
        Case{-3, "so the approach comes to rest from within 0.5 J only; raise the approach damping k21"},
        Case{-1e200, "J only; raise the approach damping k21"}}) {
    AxisDesign axis = impulsive_example();
    axis.smooth_friction_slope_Ns_per_m = c.slope_Ns_per_m;
    const DesignReport report = design_axis(axis);
    const Check& check = check_of(report, "approach_comes_to_rest");
    EXPECT_EQ(check.holds, c.slope_Ns_per_m > -0.5) << c.slope_Ns_per_m;
    EXPECT_EQ(report.certified, check.holds) << c.slope_Ns_per_m;
    EXPECT_NE(check.reason.find(c.said), std::string::npos) << check.reason;
  }
}

TEST(DesignReport, AsksOfTheSpeedOfAnApproachByImpulsesNothingButThatItMoves) {
  AxisDesign axis = impulsive_example();
  axis.period_s = 0;
  axis.max_approach_speed_m_s = 100;
  const Check ideal = check_of(design_axis(axis), "approach_gets_on");
  EXPECT_DOUBLE_EQ(ideal.margin, 100 - 1.2 * 4.5 / 0.5);
  axis.period_s = 1e-3;
  EXPECT_LT(check_of(design_axis(axis), "approach_gets_on").margin, ideal.margin)
      << "what shows a count takes force too";
}

// The velocity of so coarse an encoder is smoothed for as long, however short the period is.
TEST(DesignReport, OffersUnderTheCoastPdOnlyWhatMendsACheck) {
  struct Case {
    const char* check;
    void (*spoil)(AxisDesign&);
    const char* not_offered;
  };
  const std::vector<Case> cases{
      {"damping_tolerates_delay", [](AxisDesign& a) { a.encoder_resolution_m = a.position_tolerance_m = 3e-3; },
       "shorten the"},
      {"damping_tolerates_delay", [](AxisDesign& a) { a.latency_ticks = 70; }, "finer encoder"},
      {"tolerance_above_floor", [](AxisDesign& a) { a.period_s = 2e-3, a.least_period_s = 1.9e-3; }, "period (the"},
      {"approach_gets_on", [](AxisDesign& a) { a.max_approach_speed_m_s = 2.6; }, "k21, or take"},
      {"least_kick_outlasts_the_lag", [](AxisDesign& a) { a.position_tolerance_m = 9e-7, a.current_loop_lag_s = 1e-4; },
       "faster current loop"},
  };
  for (const Case& c : cases) {
    AxisDesign axis = impulsive_example();
    c.spoil(axis);
    const Check check = check_of(design_axis(axis), c.check);
    EXPECT_FALSE(check.holds) << c.check;
    EXPECT_EQ(check.reason.find(c.not_offered), std::string::npos) << check.reason;
  }
}

// Behind a hundred steps of 66 N its approach was seen to pass the target by more than it does without steps.
TEST(DesignReport, CountsUnderTheCoastPdWithTheStepsOfTheForce) {
  AxisDesign axis{.mass_kg = 0.00101544,
                  .stiffness_N_per_m = 0.115273,
                  .approach_damping_Ns_per_m = 0.0113754,
                  .kick_damping_Ns_per_m = 0.047751,
                  .friction = {3.23453, 15.0147},
                  .max_force_N = 66.3967,
                  .period_s = 5e-4,
                  .encoder_resolution_m = 0.000399529,
                  .latency_ticks = 1,
                  .current_loop_lag_s = 7.97673e-5,
                  .position_tolerance_m = 0.0203788,
                  .max_approach_speed_m_s = 1603.14,
                  .longest_way_m = 99831.8};
  const DesignReport smooth = design_axis(axis);
  ASSERT_TRUE(smooth.certified) << smooth.reasons.front();
  axis.force_step_N = 0.4;
  const DesignReport stepped = design_axis(axis);
  ASSERT_TRUE(stepped.certified) << stepped.reasons.front();
  EXPECT_GT(stepped.pd->beyond_m, smooth.pd->beyond_m);
  EXPECT_GT(stepped.pd->approach_s, smooth.pd->approach_s) << "half a step may hold the axis for a while";
  EXPECT_GE(stepped.pd->kicks_s, smooth.pd->kicks_s);
}
}  // namespace
