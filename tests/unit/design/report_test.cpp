#include "breakaway/design/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "../../../controller/design/src/check.hpp"
#include "../number_after.hpp"
#include "../refusal.hpp"
#include "example_axes.hpp"

namespace {

using namespace breakaway::design;
using breakaway::testing::braked_example;
using breakaway::testing::number_after;
using breakaway::testing::refusal;

// Section V of [I] behind a drive of 50 N at 1 kHz with an encoder of 1 um.
AxisDesign example() {
  return {.mass_kg = 1,
          .stiffness_N_per_m = 1,
          .approach_damping_Ns_per_m = 0.5,
          .kick_damping_Ns_per_m = 3,
          .friction = {2.5, 4.5},
          .smooth_friction_slope_Ns_per_m = 0,
          .max_force_N = 50,
          .period_s = 1e-3,
          .encoder_resolution_m = 1e-6,
          .latency_ticks = 1,
          .position_tolerance_m = 3e-6};
}

const Check* find(const DesignReport& report, const std::string& name) {
  const auto found =
      std::find_if(report.checks.begin(), report.checks.end(), [&](const Check& c) { return c.name == name; });
  return found == report.checks.end() ? nullptr : &*found;
}

TEST(DesignReport, CertifiesTheExample) {
  const auto report = design_axis(example());
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
  EXPECT_NEAR(find(report, "assumption_3_eq_17")->margin, 5.0 / 9 - 0.5, 1e-15);
  EXPECT_NEAR(find(report, "assumption_3_eq_18")->margin, 5.0 / 9 - 0.280215323972624, 1e-14);
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
    AxisDesign axis = example();
    c.spoil(axis);
    const auto report = design_axis(axis);
    EXPECT_FALSE(report.certified) << c.check;
    EXPECT_FALSE(find(report, c.check)->holds) << c.check;
    EXPECT_LE(find(report, c.check)->margin, 0) << c.check;
    ASSERT_EQ(report.reasons.size(), 1U) << c.check;
    EXPECT_EQ(report.reasons[0].find(c.check), 0U) << report.reasons[0];
    EXPECT_NE(report.reasons[0].find(c.remedy), std::string::npos) << report.reasons[0];
  }
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
  AxisDesign axis = example();
  axis.friction.lower_N = 4.5 * 0.2;
  axis.position_tolerance_m = 1e-5;
  const auto report = design_axis(axis);
  EXPECT_FALSE(find(report, "assumption_3_eq_17")->holds);
  EXPECT_FALSE(find(report, "assumption_3_eq_18")->holds);
  EXPECT_TRUE(report.certified);
}

TEST(DesignReport, DoesNotCertifyATableTooCoarseForTheRange) {
  AxisDesign axis = example();
  axis.kick_damping_Ns_per_m = 2e4;
  axis.friction.lower_N = 0.0045;
  axis.period_s = 0;
  const auto report = design_axis(axis);
  EXPECT_TRUE(find(report, "assumption_3_exact")->holds);
  EXPECT_FALSE(find(report, "table_keeps_contraction")->holds);
  EXPECT_FALSE(report.certified);
}

// An approach without damping swings to and fro until friction has taken all its energy, for hours where it takes
// little. What was seen of it until it is given up is no promise.
TEST(DesignReport, RefusesAnAxisUnderTheCoastPdThatIsTriedForTooShortATime) {
  AxisDesign axis = example();
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
  AxisDesign axis = example();
  axis.max_approach_speed_m_s = 1e6;
  axis.longest_way_m = 1e3;
  const DesignReport seen = design_axis(axis);
  EXPECT_TRUE(seen.certified) << seen.reasons.front();
  axis.longest_way_m = 1e5;
  const DesignReport report = design_axis(axis);
  ASSERT_EQ(report.reasons.size(), 1U);
  EXPECT_EQ(report.reasons[0].find("approach_ends_near: "), 0U) << report.reasons[0];
}

// A tolerance may be the very floor, which two ways of computing it round differently.
TEST(DesignReport, GivesNoCheckThatHoldsANegativeMargin) {
  AxisDesign axis = example();
  axis.position_tolerance_m = 1.8e-6;
  for (const Check& check : design_axis(axis).checks)
    if (check.holds) {
      EXPECT_GE(check.margin, 0) << check.name;
    }
}

TEST(DesignReport, LeavesSamplingOutForIdealImpulses) {
  AxisDesign axis = example();
  axis.period_s = 0;
  axis.encoder_resolution_m = 0;
  const auto report = design_axis(axis);
  EXPECT_TRUE(report.certified);
  EXPECT_EQ(report.accuracy_floor_m, 0);
  EXPECT_EQ(find(report, "force_breaks_away"), nullptr);
}

TEST(DesignReport, RemarkOnesDampingIsAccepted) {
  AxisDesign axis = example();
  axis.friction = {0.2, 4.5};
  axis.period_s = 0;
  const auto first = design_axis(axis);
  EXPECT_FALSE(find(first, "assumption_3_eq_18")->holds);
  axis.kick_damping_Ns_per_m = first.least_damping_Ns_per_m;
  EXPECT_TRUE(find(design_axis(axis), "assumption_3_eq_18")->holds);
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
    AxisDesign axis = example();
    c.spoil(axis);
    const std::string message = refusal([&] { design_axis(axis); });
    EXPECT_NE(message.find(c.named), std::string::npos) << c.named << " in: " << message;
  }
}

TEST(DesignReport, CertifiesTheBrakeByItsOwnConditions) {
  AxisDesign axis = braked_example();
  axis.kick_damping_Ns_per_m = 600;  // of no concern to the brake
  const DesignReport report = design_axis(axis);
  ASSERT_TRUE(report.certified) << report.reasons.front();
  ASSERT_TRUE(report.braked.has_value());
  EXPECT_DOUBLE_EQ(report.braked->error_m, 2.3e-6);
  EXPECT_DOUBLE_EQ(report.braked->beyond_m, 0.5e-6);
  EXPECT_GT(report.braked->most_kicks, 0);
  EXPECT_NE(report.conditions.front().find("as it likes"), std::string::npos);
  EXPECT_FALSE(design_axis(example()).braked.has_value());
}

TEST(DesignReport, SaysWithFiguresWhatIsTestedOfAnApproach) {
  AxisDesign axis = braked_example();
  const auto tested = [&axis] {
    const std::vector<std::string> all = design_axis(axis).conditions;
    return *std::ranges::find_if(all, [](const std::string& text) { return text.starts_with("tested, not proved"); });
  };
  EXPECT_EQ(tested().find("nor faster"), std::string::npos) << "its speed is not limited";
  axis.max_approach_speed_m_s = 1;
  const BrakedPromise promise = *design_axis(axis).braked;
  for (const std::string& part : {"further than " + breakaway::brief_up(promise.approach_beyond_m) + " m beyond it",
                                  "nor faster than " + breakaway::brief_up(promise.approach_peak_m_s) + " m/s"})
    EXPECT_NE(tested().find(part), std::string::npos) << part << " in: " << tested();
}

TEST(DesignReport, StatesNoConditionsOfKicksThatAreImpossible) {
  AxisDesign axis = braked_example();
  axis.braked->max_force_N = axis.max_force_N = 4;
  const DesignReport report = design_axis(axis);
  ASSERT_FALSE(report.braked.has_value());
  EXPECT_FALSE(report.certified);
  EXPECT_TRUE(report.conditions.empty());
}

TEST(DesignReport, SaysThatALimitOfTheFollowingErrorMustLeaveTheWayToTurn) {
  AxisDesign axis = braked_example();
  const auto said = [&axis] {
    const auto conditions = design_axis(axis).conditions;
    return std::count_if(conditions.begin(), conditions.end(),
                         [](const std::string& c) { return c.find("following_error_m") != std::string::npos; });
  };
  EXPECT_EQ(said(), 0);
  axis.following_error_m = 0.1;
  EXPECT_EQ(said(), 1);
}

TEST(DesignReport, PromisesTheFloorWhereTheFineStageAimsBelowIt) {
  AxisDesign axis = braked_example();
  axis.position_tolerance_m = axis.braked->fine_tolerance_m = 0.6e-6;
  axis.settle_tolerance_m = 3e-6;
  const DesignReport report = design_axis(axis);
  ASSERT_TRUE(report.certified) << report.reasons.front();
  const BrakedPromise& promise = *report.braked;
  EXPECT_TRUE(promise.fine_stage);
  EXPECT_DOUBLE_EQ(promise.error_m, promise.floor_m + 0.5e-6);
  EXPECT_DOUBLE_EQ(promise.beyond_m, 1.35 * promise.floor_m + 0.5e-6);
  EXPECT_NE(promise.promise.find("aims at 6e-07 m, which is not promised"), std::string::npos) << promise.promise;
  AxisDesign at_the_floor = braked_example();
  at_the_floor.position_tolerance_m = promise.floor_m;
  const BrakedPromise by_table = *design_axis(at_the_floor).braked;
  EXPECT_FALSE(by_table.fine_stage);
  EXPECT_GT(promise.most_kicks, by_table.most_kicks + 40);
  EXPECT_GT(promise.kicks_s, by_table.kicks_s);
  axis.settle_tolerance_m = 2e-6;
  EXPECT_FALSE(design_axis(axis).certified) << "the floor is not good enough";
}

TEST(DesignReport, RefusesWhatNoBrakedKickReachesByName) {
  const struct {
    const char* check;
    void (*spoil)(AxisDesign&);
  } spoiled[] = {
      {"tolerance_above_floor", [](AxisDesign& a) { a.position_tolerance_m = 1.5e-6; }},
      {"tolerance_above_floor",
       [](AxisDesign& a) {
         a.braked->mass_kg = {0.5, 1.5};
       }},
      {"latency_is_bridged", [](AxisDesign& a) { a.braked->latency_periods = 9; }},
      {"pulse_breaks_away", [](AxisDesign& a) { a.braked->max_force_N = 4.5; }},
      {"brake_lets_the_axis_rest", [](AxisDesign& a) { a.braked->load_N = 2.5; }},
      {"kicks_contract",
       [](AxisDesign& a) {
         a.braked->mass_kg = {0.01, 1};
       }},
      {"rest_is_seen_in_time", [](AxisDesign& a) { a.braked->encoder_resolution_m = 1e4; }},
      {"kicks_are_few",
       [](AxisDesign& a) {
         a.position_tolerance_m = 4e-5;
         a.braked->mass_kg = {0.1, 1};
       }},
  };
  for (const auto& s : spoiled) {
    AxisDesign axis = braked_example();
    s.spoil(axis);
    const DesignReport report = design_axis(axis);
    EXPECT_FALSE(report.certified) << s.check;
    const bool named =
        std::ranges::any_of(report.reasons, [&](const std::string& r) { return r.starts_with(s.check); });
    EXPECT_TRUE(named) << s.check << " is not among the reasons";
  }
}

// Each of them alone, typed in.
TEST(DesignReport, HasFewKicksWithEachNumberThatItNames) {
  AxisDesign axis = braked_example();
  axis.position_tolerance_m = 4e-5;
  axis.braked->mass_kg = {0.1, 1};
  const std::string reason = find(design_axis(axis), "kicks_are_few")->reason;
  const auto expect_few = [&](const AxisDesign& other) {
    const Check check = *find(design_axis(other), "kicks_are_few");
    EXPECT_TRUE(check.holds) << reason << "\n" << check.reason;
  };
  AxisDesign wider = axis;
  wider.position_tolerance_m = number_after(reason, "widen the tolerance to ");
  expect_few(wider);
  const struct {
    const char* words;
    double BrakedClass::*number;
  } others[] = {{"use a drive of ", &BrakedClass::max_force_N},
                {"steps of force of ", &BrakedClass::force_step_N},
                {"encoder_resolution_m of ", &BrakedClass::encoder_resolution_m}};
  for (const auto& o : others) {
    if (reason.find(o.words) == std::string::npos) continue;
    AxisDesign other = axis;
    (*other.braked).*o.number = number_after(reason, o.words);
    expect_few(other);
  }
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
    AxisDesign axis = example();
    axis.smooth_friction_slope_Ns_per_m = c.slope_Ns_per_m;
    const DesignReport report = design_axis(axis);
    const Check& check = *find(report, "approach_comes_to_rest");
    EXPECT_EQ(check.holds, c.slope_Ns_per_m > -0.5) << c.slope_Ns_per_m;
    EXPECT_EQ(report.certified, check.holds) << c.slope_Ns_per_m;
    EXPECT_NE(check.reason.find(c.said), std::string::npos) << check.reason;
  }
}

TEST(DesignReport, AsksOfTheSpeedOfAnApproachByImpulsesNothingButThatItMoves) {
  AxisDesign axis = example();
  axis.period_s = 0;
  axis.max_approach_speed_m_s = 100;
  const Check ideal = *find(design_axis(axis), "approach_gets_on");
  EXPECT_DOUBLE_EQ(ideal.margin, 100 - 1.2 * 4.5 / 0.5);
  axis.period_s = 1e-3;
  EXPECT_LT(find(design_axis(axis), "approach_gets_on")->margin, ideal.margin) << "what shows a count takes force too";
}

AxisDesign moved_example() {
  AxisDesign axis = braked_example();
  axis.braked->move = MoveRequest{.distance_m = 0.5, .speed_m_s = 0.5, .acceleration_m_s2 = 20};
  return axis;
}

TEST(DesignReport, CertifiesAMoveWithoutALimitOfItsJerk) {
  AxisDesign axis = moved_example();
  const DesignReport report = design_axis(axis);
  ASSERT_TRUE(report.certified) << report.reasons.front();
  EXPECT_TRUE(find(report, "speed_margin_is_small")->holds);
  EXPECT_EQ(find(report, "jerk_can_be_followed"), nullptr);
  // Speeding up and braking take a fortieth of a second each, and half the way of that time at full speed.
  EXPECT_NEAR(report.braked->least_move_s, 0.5 / 0.5 + 0.5 / 20, 1e-12);
  AxisDesign still = axis;
  still.braked->move.reset();
  const double in_a_period_m = 20 * 1e-3 * 1e-3;
  EXPECT_GT(report.braked->approach_beyond_m, in_a_period_m);
  EXPECT_LT(report.braked->approach_beyond_m, design_axis(still).braked->approach_beyond_m + in_a_period_m)
      << "a move brakes more gently";
  axis.braked->move->jerk_m_s3 = 2000;
  EXPECT_NE(find(design_axis(axis), "jerk_can_be_followed"), nullptr);
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
    AxisDesign axis = example();
    c.spoil(axis);
    const Check check = *find(design_axis(axis), c.check);
    EXPECT_FALSE(check.holds) << c.check;
    EXPECT_EQ(check.reason.find(c.not_offered), std::string::npos) << check.reason;
  }
}

// Both ends of the range that a refused jerk is told.
TEST(DesignReport, HoldsWithTheJerksThatItNames) {
  for (const double mass_kg : {0.97, 1.01, 1.03, 1.07}) {
    AxisDesign axis = moved_example();
    axis.mass_kg = mass_kg;
    axis.braked->mass_kg = {mass_kg, mass_kg};
    axis.braked->move->jerk_m_s3 = 1;
    const std::string reason = find(design_axis(axis), "jerk_leaves_time_to_brake")->reason;
    for (const char* words : {"take one between ", " and "}) {
      axis.braked->move->jerk_m_s3 = number_after(reason.substr(reason.find("take one")), words);
      const DesignReport report = design_axis(axis);
      EXPECT_TRUE(find(report, "jerk_leaves_time_to_brake")->holds) << mass_kg << reason;
      EXPECT_TRUE(find(report, "jerk_can_be_followed")->holds) << mass_kg << reason;
    }
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

// Under a brake of nine tenths of the least friction even that takes 4.75 m/s2 of a kilogram.
TEST(DesignReport, OffersToKnowMoreOfAMoveOnlyWhereThatMayDo) {
  AxisDesign moved = moved_example();
  const auto reason = [&](double acceleration_m_s2) {
    moved.braked->move->acceleration_m_s2 = acceleration_m_s2;
    const DesignReport report = design_axis(moved);
    const Check* const check = find(report, "move_can_be_made");
    return check->holds ? std::string{} : check->reason;
  };
  EXPECT_NE(reason(5.5).find("; raise it to "), std::string::npos) << reason(5.5);
  EXPECT_NE(reason(5.5).find("know friction"), std::string::npos) << reason(5.5);
  const std::string slow = reason(4);
  EXPECT_EQ(slow.find("know friction"), std::string::npos) << slow;
  const double told_m_s2 = std::stod(slow.substr(slow.find("raise it to ") + 12));
  EXPECT_EQ(reason(told_m_s2), "");
  EXPECT_NE(reason(0.98 * told_m_s2), "");
}

// What a drive or a load makes impossible is named alone: the rest would be of a design that there is not.
TEST(DesignReport, SaysNoMoreOfMoveAndSpringThanThereIsOfADesign) {
  AxisDesign weak = moved_example();
  weak.braked->max_force_N = 4.5;
  const DesignReport of_weak = design_axis(weak);
  EXPECT_NE(find(of_weak, "move_can_be_made"), nullptr);
  EXPECT_EQ(find(of_weak, "speed_is_seen_well_enough"), nullptr);
  EXPECT_TRUE(of_weak.reasons.front().starts_with("pulse_breaks_away")) << of_weak.reasons.front();

  AxisDesign driven = moved_example();
  driven.braked->spring_load = SpringLoad{0.4, 0.6, 1e7, {1.3, 2.4}, {1.2, 2.1}};
  EXPECT_NE(find(design_axis(driven), "spring_keeps_the_target"), nullptr);
  driven.braked->load_N = 2.5;
  const DesignReport of_driven = design_axis(driven);
  EXPECT_EQ(find(of_driven, "move_can_be_made"), nullptr);
  EXPECT_EQ(find(of_driven, "spring_keeps_the_target"), nullptr);
  EXPECT_TRUE(of_driven.reasons.front().starts_with("brake_lets_the_axis_rest")) << of_driven.reasons.front();
}

}  // namespace
