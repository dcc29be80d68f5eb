// What a report says of the coast "brake" and of its moves.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "../number_after.hpp"
#include "check_of.hpp"
#include "example_axes.hpp"

namespace {

using namespace breakaway::design;
using breakaway::testing::braked_example;
using breakaway::testing::check_of;
using breakaway::testing::has_check;
using breakaway::testing::impulsive_example;
using breakaway::testing::number_after;

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
  EXPECT_FALSE(design_axis(impulsive_example()).braked.has_value());
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

TEST(DesignReport, CountsKicksFromTheOneDistanceAtWhichItSaysThatTheyBegin) {
  const DesignReport report = design_axis(braked_example());
  const std::string reason = check_of(report, "kicks_are_few").reason;
  const double from_m = number_after(reason, "may be needed from ");
  EXPECT_GT(from_m, report.braked->hand_over_m) << "where the approach gives way is another distance";
  EXPECT_NE(reason.find("kicks begin"), std::string::npos) << reason;
  EXPECT_DOUBLE_EQ(from_m, number_after(report.braked->promise, "and from ")) << report.braked->promise;
}

TEST(DesignReport, SaysWithAFigureWhatOthersOnTheWireMayDelay) {
  AxisDesign axis = braked_example();
  const auto said = [&axis](const std::string& figure) {
    const std::vector<std::string> all = design_axis(axis).conditions;
    return std::ranges::any_of(all, [&](const std::string& text) { return text.ends_with("jitter_s = " + figure); });
  };
  EXPECT_TRUE(said("0 s"));
  axis.braked->jitter_s = 1e-4;
  EXPECT_TRUE(said("0.0001 s"));
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
  struct Way {
    const char* words;
    void (*take)(AxisDesign&, double);
  };
  const Way tolerance{"widen the tolerance to ", [](AxisDesign& a, double m) { a.position_tolerance_m = m; }};
  const Way drive{"use a drive of ", [](AxisDesign& a, double N) { a.max_force_N = a.braked->max_force_N = N; }};
  const Way steps{"steps of force of ", [](AxisDesign& a, double N) { a.braked->force_step_N = N; }};
  const Way encoder{"encoder_resolution_m of ",
                    [](AxisDesign& a, double m) { a.encoder_resolution_m = a.braked->encoder_resolution_m = m; }};
  const struct {
    double least_mass_kg, force_N, step_N, count_m, tolerance_m;
    std::vector<Way> ways;
  } axes[] = {{0.1, 50, 0.025, 1e-6, 4e-5, {tolerance}},
              {0.3, 6, 0.5, 1e-4, 5.202e-5, {tolerance, drive, encoder}},
              {0.1, 50, 1, 1e-5, 1.2223e-4, {steps}}};
  for (const auto& a : axes) {
    AxisDesign axis = braked_example();
    axis.braked->mass_kg = {a.least_mass_kg, 1};
    drive.take(axis, a.force_N);
    steps.take(axis, a.step_N);
    encoder.take(axis, a.count_m);
    tolerance.take(axis, a.tolerance_m);
    const std::string reason = check_of(design_axis(axis), "kicks_are_few").reason;
    for (const Way& way : a.ways) {
      ASSERT_NE(reason.find(way.words), std::string::npos) << reason;
      AxisDesign other = axis;
      way.take(other, number_after(reason, way.words));
      EXPECT_TRUE(check_of(design_axis(other), "kicks_are_few").holds) << reason;
    }
  }
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
  EXPECT_TRUE(check_of(report, "speed_margin_is_small").holds);
  EXPECT_FALSE(has_check(report, "jerk_can_be_followed"));
  // Speeding up and braking take a fortieth of a second each, and half the way of that time at full speed.
  EXPECT_NEAR(report.braked->least_move_s, 0.5 / 0.5 + 0.5 / 20, 1e-12);
  AxisDesign still = axis;
  still.braked->move.reset();
  const double in_a_period_m = 20 * 1e-3 * 1e-3;
  EXPECT_GT(report.braked->approach_beyond_m, in_a_period_m);
  EXPECT_LT(report.braked->approach_beyond_m, design_axis(still).braked->approach_beyond_m + in_a_period_m)
      << "a move brakes more gently";
  axis.braked->move->jerk_m_s3 = 2000;
  EXPECT_TRUE(has_check(design_axis(axis), "jerk_can_be_followed"));
}

// Both ends of the range that a refused jerk is told.
TEST(DesignReport, HoldsWithTheJerksThatItNames) {
  for (const double mass_kg : {0.97, 1.01, 1.03, 1.07}) {
    AxisDesign axis = moved_example();
    axis.mass_kg = mass_kg;
    axis.braked->mass_kg = {mass_kg, mass_kg};
    axis.braked->move->jerk_m_s3 = 1;
    const std::string reason = check_of(design_axis(axis), "jerk_leaves_time_to_brake").reason;
    for (const char* words : {"take one between ", " and "}) {
      axis.braked->move->jerk_m_s3 = number_after(reason.substr(reason.find("take one")), words);
      const DesignReport report = design_axis(axis);
      EXPECT_TRUE(check_of(report, "jerk_leaves_time_to_brake").holds) << mass_kg << reason;
      EXPECT_TRUE(check_of(report, "jerk_can_be_followed").holds) << mass_kg << reason;
    }
  }
}

// Under a brake of nine tenths of the least friction even that takes 4.75 m/s2 of a kilogram.
TEST(DesignReport, OffersToKnowMoreOfAMoveOnlyWhereThatMayDo) {
  AxisDesign moved = moved_example();
  const auto reason = [&](double acceleration_m_s2) {
    moved.braked->move->acceleration_m_s2 = acceleration_m_s2;
    const Check check = check_of(design_axis(moved), "move_can_be_made");
    return check.holds ? std::string{} : check.reason;
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
  EXPECT_TRUE(has_check(of_weak, "move_can_be_made"));
  EXPECT_FALSE(has_check(of_weak, "speed_is_seen_well_enough"));
  EXPECT_TRUE(of_weak.reasons.front().starts_with("pulse_breaks_away")) << of_weak.reasons.front();

  AxisDesign driven = moved_example();
  driven.braked->spring_load = SpringLoad{0.4, 0.6, 1e7, {1.3, 2.4}, {1.2, 2.1}};
  EXPECT_TRUE(has_check(design_axis(driven), "spring_keeps_the_target"));
  driven.braked->load_N = 2.5;
  const DesignReport of_driven = design_axis(driven);
  EXPECT_FALSE(has_check(of_driven, "move_can_be_made"));
  EXPECT_FALSE(has_check(of_driven, "spring_keeps_the_target"));
  EXPECT_TRUE(of_driven.reasons.front().starts_with("brake_lets_the_axis_rest")) << of_driven.reasons.front();
}
}  // namespace
