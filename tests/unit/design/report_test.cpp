#include "breakaway/design/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../../../controller/design/src/check.hpp"
#include "../refusal.hpp"
#include "check_of.hpp"
#include "example_axes.hpp"

namespace {

using namespace breakaway::design;
using breakaway::testing::check_of;
using breakaway::testing::has_check;
using breakaway::testing::impulsive_example;
using breakaway::testing::refusal;

TEST(DesignReport, CertifiesTheExample) {
  const auto report = design_axis(impulsive_example());
  EXPECT_TRUE(report.certified);
  EXPECT_TRUE(report.reasons.empty());
  EXPECT_DOUBLE_EQ(report.zeta_approach, 0.25);
  EXPECT_DOUBLE_EQ(report.zeta_kick, 1.5);
  EXPECT_DOUBLE_EQ(report.c_lower_m, 2.5);
  EXPECT_DOUBLE_EQ(report.c_upper_m, 4.5);
  EXPECT_DOUBLE_EQ(report.accuracy_floor_m, 1.8e-6);
  EXPECT_DOUBLE_EQ(report.contraction_per_kick, 2.0 / 4.5);
  EXPECT_NEAR(report.finite_time_bound_s, std::sqrt(2.0) * 3, 1e-14);  // sqrt(2 c_lower / 2.5) / (1 - sqrt(4/9))
  EXPECT_LE(report.table_bytes, 2150U);
  EXPECT_LE(report.table_proved_error, 4e-7);
  EXPECT_NEAR(check_of(report, "assumption_3_eq_17").margin, 5.0 / 9 - 0.5, 1e-15);
  EXPECT_NEAR(check_of(report, "assumption_3_eq_18").margin, 5.0 / 9 - 0.280215323972624, 1e-14);
}

TEST(DesignReport, NamesWhatFailsAndTheRemedy) {
  struct Case {
    const char* check;
    void (*spoil)(AxisDesign&);
    const char* remedy;
  };
  const std::vector<Case> cases{
      {"assumption_2_proposition_2", [](AxisDesign& a) { a.approach_damping_Ns_per_m = 2; },
       "lower the approach damping"},
      {"assumption_2_proposition_3", [](AxisDesign& a) { a.smooth_friction_slope_Ns_per_m = 1.6; },
       "lower the approach damping"},
      {"assumption_3_exact", [](AxisDesign& a) { a.friction.lower_N = 0.8, a.position_tolerance_m = 1e-3; },
       "raise the damping k22"},
      {"force_breaks_away", [](AxisDesign& a) { a.max_force_N = 1.49 * a.friction.upper_N; }, "stronger drive"},
      {"force_is_fine", [](AxisDesign& a) { a.force_step_N = 0.26 * a.friction.lower_N; }, "finer step of force"},
      {"tolerance_above_floor", [](AxisDesign& a) { a.period_s = 2e-3; }, "shorten the period"},
      {"tolerance_above_encoder_resolution", [](AxisDesign& a) { a.encoder_resolution_m = 4e-6; }, "finer encoder"},
      {"damping_tolerates_delay", [](AxisDesign& a) { a.latency_ticks = 70; },
       "or shorten the period, or shorten the latency"},
      // So coarse a count has the velocity smoothed over 24 periods.
      {"velocity_is_seen", [](AxisDesign& a) { a.encoder_resolution_m = a.position_tolerance_m = 1e-3; },
       "use a finer encoder"},
      {"friction_bounds_are_apart", [](AxisDesign& a) { a.friction.lower_N = 4.45; }, "state wider bounds"},
      {"least_kick_outlasts_the_lag",
       [](AxisDesign& a) {
         a.friction.lower_N = 4.3, a.current_loop_lag_s = 0.19 * a.period_s;
         a.position_tolerance_m = 1.1e-7, a.encoder_resolution_m = 1e-8;
       },
       "faster current loop"},
      {"current_loop_is_fast", [](AxisDesign& a) { a.current_loop_lag_s = 0.3 * a.period_s; }, "coast = \"brake\""},
  };
  for (const Case& c : cases) {
    AxisDesign axis = impulsive_example();
    c.spoil(axis);
    const auto report = design_axis(axis);
    EXPECT_FALSE(report.certified) << c.check;
    EXPECT_FALSE(check_of(report, c.check).holds) << c.check;
    EXPECT_LE(check_of(report, c.check).margin, 0) << c.check;
    ASSERT_EQ(report.reasons.size(), 1U) << c.check;
    EXPECT_EQ(report.reasons[0].find(c.check), 0U) << report.reasons[0];
    EXPECT_NE(report.reasons[0].find(c.remedy), std::string::npos) << report.reasons[0];
  }
}

TEST(DesignReport, NamesTheKeyOfAFrictionThatRisesWithSpeed) {
  const std::vector<std::string> conditions = design_axis(impulsive_example()).conditions;
  EXPECT_TRUE(std::ranges::any_of(conditions, [](const std::string& text) {
    return text.find("state [friction] smooth_slope_Ns_per_m,") != std::string::npos;
  }));
}

std::string reason_of(double value, double limit, detail::Equality equality = detail::Equality::fails) {
  return detail::below("a_check", "a source", value, limit, "one against the other", "change it", equality).reason;
}

TEST(CheckReason, ShowsByHowLittleANumberFails) {
  EXPECT_EQ(reason_of(0.03814699, 0.038146972), "one against the other: 0.03814699 is not below 0.03814697; change it");
}

TEST(CheckReason, SaysInWordsThatNothingFiniteIsEnough) {
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(reason_of(infinite, 128, detail::Equality::holds),
            "one against the other: no finite number suffices, and it must be at most 128; change it");
}

TEST(CheckReason, ShowsNoDigitsThatARoundingMadeOfACheckThatHolds) {
  EXPECT_EQ(reason_of(0.1 + 0.2, 0.3, detail::Equality::holds), "one against the other: 0.3 is at most 0.3");
}

// (17) and (18) are sufficient only: between (18) and the exact threshold the axis is still certified.
TEST(DesignReport, CertifiesByTheExactThresholdWhereThePaperCannot) {
  AxisDesign axis = impulsive_example();
  axis.friction.lower_N = 4.5 * 0.2;
  axis.position_tolerance_m = 1e-5;
  const auto report = design_axis(axis);
  EXPECT_FALSE(check_of(report, "assumption_3_eq_17").holds);
  EXPECT_FALSE(check_of(report, "assumption_3_eq_18").holds);
  EXPECT_TRUE(report.certified);
}

TEST(DesignReport, DoesNotCertifyATableTooCoarseForTheRange) {
  AxisDesign axis = impulsive_example();
  axis.kick_damping_Ns_per_m = 2e4;
  axis.friction.lower_N = 0.0045;
  axis.period_s = 0;
  const auto report = design_axis(axis);
  EXPECT_TRUE(check_of(report, "assumption_3_exact").holds);
  EXPECT_FALSE(check_of(report, "table_keeps_contraction").holds);
  EXPECT_FALSE(report.certified);
}

// A tolerance may be the very floor, which two ways of computing it round differently.
TEST(DesignReport, GivesNoCheckThatHoldsANegativeMargin) {
  AxisDesign axis = impulsive_example();
  axis.position_tolerance_m = 1.8e-6;
  for (const Check& check : design_axis(axis).checks)
    if (check.holds) {
      EXPECT_GE(check.margin, 0) << check.name;
    }
}

TEST(DesignReport, LeavesSamplingOutForIdealImpulses) {
  AxisDesign axis = impulsive_example();
  axis.period_s = 0;
  axis.encoder_resolution_m = 0;
  const auto report = design_axis(axis);
  EXPECT_TRUE(report.certified);
  EXPECT_EQ(report.accuracy_floor_m, 0);
  EXPECT_FALSE(has_check(report, "force_breaks_away"));
}

TEST(DesignReport, RemarkOnesDampingIsAccepted) {
  AxisDesign axis = impulsive_example();
  axis.friction = {0.2, 4.5};
  axis.period_s = 0;
  const auto first = design_axis(axis);
  EXPECT_FALSE(check_of(first, "assumption_3_eq_18").holds);
  axis.kick_damping_Ns_per_m = first.least_damping_Ns_per_m;
  EXPECT_TRUE(check_of(design_axis(axis), "assumption_3_eq_18").holds);
}

TEST(DesignReport, RefusesImpossibleAxesByName) {
  struct Case {
    void (*spoil)(AxisDesign&);
    const char* named;
  };
  const std::vector<Case> cases{
      {[](AxisDesign& a) { a.mass_kg = 0; }, "mass_kg is 0"},
      {[](AxisDesign& a) { a.stiffness_N_per_m = -1; }, "stiffness k1 is -1"},
      {[](AxisDesign& a) { a.approach_damping_Ns_per_m = std::numeric_limits<double>::quiet_NaN(); }, "k21 is nan"},
      {[](AxisDesign& a) { a.kick_damping_Ns_per_m = 2; }, "zeta > 1"},
      {[](AxisDesign& a) {
         a.friction = {5, 4};
       },
       "friction_lower_N is 5, above friction_upper_N = 4"},
      {[](AxisDesign& a) { a.smooth_friction_slope_Ns_per_m = INFINITY; }, "smooth_friction_slope_Ns_per_m"},
      {[](AxisDesign& a) { a.max_force_N = 0; }, "max_force_N is 0"},
      {[](AxisDesign& a) { a.period_s = -1; }, "period_s is -1"},
      {[](AxisDesign& a) { a.encoder_resolution_m = -1; }, "encoder_resolution_m is -1"},
      {[](AxisDesign& a) { a.latency_ticks = -1; }, "latency_ticks is -1"},
      {[](AxisDesign& a) { a.position_tolerance_m = 0; }, "position_tolerance_m is 0"},
  };
  for (const Case& c : cases) {
    AxisDesign axis = impulsive_example();
    c.spoil(axis);
    const std::string message = refusal([&] { design_axis(axis); });
    EXPECT_NE(message.find(c.named), std::string::npos) << c.named << " in: " << message;
  }
}
}  // namespace
