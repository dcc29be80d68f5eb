// What is said of a tolerance, or behind a current loop, that is out of reach.
#include "../../../controller/design/src/reachable.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "../../campaign/environment.hpp"
#include "../number_after.hpp"
#include "example_axes.hpp"

namespace breakaway::design {
namespace {

using testing::braked_example;
using testing::number_after;

BrakedClass counted_axes() { return *braked_example().braked; }

std::string ways(const BrakedClass& c, double tolerance_m, double least_period_s = 1e-5) {
  return detail::ways_to_reach(c, design_braked_kicks<float>(c), tolerance_m, least_period_s);
}

TEST(WaysToReach, NameANoiseWhereNoCountOfAnEncoderWouldDo) {
  BrakedClass c = counted_axes();
  c.encoder_noise_m = 1e-6;
  const std::string said = ways(c, 1e-6);
  EXPECT_TRUE(said.starts_with("widen it to ")) << said;
  c.encoder_noise_m = number_after(said, " m with an encoder_noise_m of ");
  c.encoder_resolution_m = number_after(said, "or take an encoder_resolution_m of ");
  EXPECT_LE(design_braked_kicks<float>(c).least_reading_m, 1e-6) << said;
}

// It grows with the way that is counted, and no encoder changes it.
TEST(WaysToReach, NameNoNoiseBelowTheRoundingOfAFloat) {
  BrakedClass c = counted_axes();
  c.encoder_noise_m = c.rounding_m = 1e-6;
  const std::string said = ways(c, 1e-6);
  EXPECT_TRUE(said.ends_with(" m, or narrow [limits] of position, where the drive's float is finer")) << said;
}

// A file states its noise beside that rounding, and no count that is finer than the float.
TEST(WaysToReach, NameTheNoiseThatAFileStatesBesideTheRoundingOfAFloat) {
  BrakedClass c = counted_axes();
  c.rounding_m = 1e-7;
  c.encoder_noise_m = 1.5e-6;
  const std::string said = ways(c, 1.2e-6);
  const double stated_m = number_after(said, " with an encoder_noise_m of ");
  c.encoder_noise_m = stated_m + c.rounding_m;
  c.encoder_resolution_m = number_after(said, "or take an encoder_resolution_m of ");
  EXPECT_LE(design_braked_kicks<float>(c).least_reading_m, 1.2e-6) << said;
  EXPECT_GE(c.encoder_resolution_m, 2 * c.rounding_m) << said;
  c = counted_axes();
  c.rounding_m = c.encoder_noise_m = 4e-7;
  EXPECT_TRUE(ways(c, 1.2e-6).ends_with(" the drive's float is finer")) << ways(c, 1.2e-6);
}

// A fine count whose noise is all that hides the tolerance.
TEST(WaysToReach, NameANoiseAloneWhereTheCountTells) {
  BrakedClass c = counted_axes();
  c.encoder_resolution_m = 1e-8;
  c.encoder_noise_m = 2e-6;
  const std::string said = ways(c, 3e-6);
  EXPECT_EQ(said.find("encoder_resolution_m"), std::string::npos) << said;
  c.encoder_noise_m = number_after(said, "or take an encoder with an encoder_noise_m of ");
  EXPECT_LE(design_braked_kicks<float>(c).least_tolerance_m, 3e-6) << said;
}

TEST(WaysToReach, NameNoPeriodWhereFrictionBends) {
  BrakedClass c = counted_axes();
  c.presliding_stiffness_N_per_m = 1e6;
  EXPECT_EQ(ways(c, 0.9e-6).find("period_s"), std::string::npos) << ways(c, 0.9e-6);
  c.presliding_stiffness_N_per_m = 0;
  EXPECT_NE(ways(c, 0.9e-6).find("or shorten period_s to "), std::string::npos) << ways(c, 0.9e-6);
}

// A mass that is known to a factor of ten lets each kick take little off, so that more are needed than the law allows,
// however short the period. With a finer count some period will do.
TEST(WaysToReach, NameNoPeriodWithWhichKicksAreTooMany) {
  BrakedClass fine = counted_axes();
  fine.mass_kg = {0.1, 1};
  const double floor_m = design_braked_kicks<float>(fine).least_tolerance_m;
  EXPECT_NE(ways(fine, floor_m).find("or shorten period_s to "), std::string::npos) << ways(fine, floor_m);
  for (const double count_m : {1e-5, 3e-5}) {
    BrakedClass c = fine;
    c.encoder_resolution_m = count_m;
    const auto design = design_braked_kicks<float>(c);
    const double tolerance_m = 1.01 * design.least_tolerance_m;
    const std::string said = ways(c, tolerance_m);
    EXPECT_EQ(said.find("period_s"), std::string::npos) << said;
    EXPECT_EQ(said.find("fine stage"), std::string::npos) << "nor with the kicks of the fine stage: " << said;
  }
}

// 60C2h holds a whole number up to 255 and a power of ten.
TEST(WaysToReach, NamePeriodsThatDrivesCanBeTold) {
  constexpr std::string_view key = "or shorten period_s to ";
  for (const double tolerance_m : {1.7e-6, 1.5e-6, 1.3e-6, 1.1e-6, 0.9e-6, 0.8e-6, 0.7e-6}) {
    const std::string said = ways(counted_axes(), tolerance_m);
    const auto at = said.find(key);
    ASSERT_NE(at, std::string::npos) << said;
    const double period_us = 1e6 * std::stod(said.substr(at + key.size()));
    const double unit_us = period_us > 255 ? 10 : 1;
    EXPECT_NEAR(period_us / unit_us, std::round(period_us / unit_us), 1e-6) << said;
  }
}

// A bus has no room for the frames of any shorter one.
TEST(WaysToReach, NameNoPeriodThatDoesNotFitTheBus) {
  const double period_s = number_after(ways(counted_axes(), 0.9e-6), "or shorten period_s to ");
  EXPECT_NE(ways(counted_axes(), 0.9e-6, period_s).find("period_s"), std::string::npos);
  const std::string said = ways(counted_axes(), 0.9e-6, 1.01 * period_s);
  EXPECT_EQ(said.find("period_s"), std::string::npos) << said;
}

// 50 steps of force are a list of pulses with gaps.
TEST(WaysToReach, NameStepsOfForceThatReachTheToleranceByThemselvesOrWithTheFineStage) {
  for (const double share : {0.3, 0.6, 0.9, 0.99}) {
    BrakedClass c = counted_axes();
    c.encoder_resolution_m = 1e-8;
    c.force_step_N = 1;
    const double tolerance_m = share * design_braked_kicks<float>(c).least_tolerance_m;
    const std::string said = ways(c, tolerance_m);
    c.force_step_N = number_after(said, "with steps of force of ");
    const auto finer = design_braked_kicks<float>(c);
    ASSERT_TRUE(finer.possible()) << said;
    if (said.find("fine stage") == std::string::npos)
      EXPECT_LE(finer.least_tolerance_m, tolerance_m) << said;
    else
      EXPECT_LE(detail::error_at_rest_m(c, finer.least_tolerance_m), number_after(said, "settle_tolerance_m = "));
  }
}

// With more jitter no shorter period is left, and the count alone does not mend the floor.
TEST(WaysToReach, NameACountByItselfOnlyWhereThatIsEnough) {
  BrakedClass c = counted_axes();
  c.jitter_s = 0.45e-3;
  c.encoder_resolution_m = 1e-5;
  const std::string said = ways(c, 1e-6);
  EXPECT_TRUE(said.starts_with("widen it to ")) << said;
  EXPECT_NE(said.find(" m and have the fine stage aim at it", said.find("encoder_resolution_m")), std::string::npos)
      << said;
  c.jitter_s = 0;
  EXPECT_NE(ways(c, 1e-6).find("encoder_resolution_m"), std::string::npos) << ways(c, 1e-6);
}

// The instants of the loop may be off by half a period at most.
TEST(WaysToReach, NameNoPeriodOfWhichTheJitterIsMoreThanHalf) {
  BrakedClass c = counted_axes();
  EXPECT_NE(ways(c, 1.2e-6).find("or shorten period_s to "), std::string::npos) << ways(c, 1.2e-6);
  c.jitter_s = 0.45e-3;
  EXPECT_EQ(ways(c, 1.2e-6).find("period_s"), std::string::npos) << ways(c, 1.2e-6);
}

// Its first reason offers a tolerance, with which it is certified; the others are for the caller.
std::string said_of_too_narrow_a_tolerance(const AxisDesign& axis) {
  const DesignReport report = design_axis(axis);
  EXPECT_FALSE(report.certified);
  const std::string said = report.reasons.empty() ? "" : report.reasons.front();
  AxisDesign wider = axis;
  wider.position_tolerance_m = number_after(said, "widen it to ");
  EXPECT_TRUE(design_axis(wider).certified) << said;
  return said;
}

TEST(DesignReport, SaysWithNumbersThatHoldWhatAToleranceBelowTheFloorTakes) {
  AxisDesign axis = braked_example();
  axis.position_tolerance_m = axis.braked->fine_tolerance_m = 1.2e-6;
  const std::string said = said_of_too_narrow_a_tolerance(axis);
  AxisDesign quicker = axis;
  quicker.period_s = quicker.braked->period_s = number_after(said, "shorten period_s to ");
  EXPECT_TRUE(design_axis(quicker).certified) << said;
  EXPECT_GT(quicker.period_s, 0.7e-3) << said;
  AxisDesign fine = axis;
  fine.settle_tolerance_m = number_after(said, "settle_tolerance_m = ");
  EXPECT_TRUE(design_axis(fine).certified) << said;
  EXPECT_TRUE(design_axis(fine).braked->fine_stage);
}

TEST(DesignReport, SaysWithNumbersThatHoldWhatAToleranceBelowTheEncoderTakes) {
  AxisDesign axis = braked_example();
  axis.position_tolerance_m = axis.braked->fine_tolerance_m = 0.3e-6;
  axis.settle_tolerance_m = 1;
  const std::string said = said_of_too_narrow_a_tolerance(axis);
  AxisDesign finer = axis;
  finer.encoder_resolution_m = number_after(said, "encoder_resolution_m of ");
  finer.braked->encoder_resolution_m = finer.encoder_resolution_m;
  EXPECT_TRUE(design_axis(finer).certified) << said << design_axis(finer).reasons.front();
  finer.settle_tolerance_m = 0;
  finer.period_s = finer.braked->period_s = number_after(said, "with a period_s of ");
  EXPECT_TRUE(design_axis(finer).certified) << said << design_axis(finer).reasons.front();
}

TEST(DesignReport, HasNoFineStageWhereTheDriveKnowsAFewForcesOnly) {
  AxisDesign axis = braked_example();
  axis.braked->force_step_N = 1;
  axis.position_tolerance_m = axis.braked->fine_tolerance_m = 1.5e-6;
  axis.settle_tolerance_m = 1;
  const DesignReport report = design_axis(axis);
  ASSERT_FALSE(report.certified);
  axis.braked->force_step_N = number_after(report.reasons.front(), "with steps of force of ");
  EXPECT_TRUE(design_axis(axis).certified);
}

TEST(DesignReport, NamesACurrentLoopThatIsTooSlowForAnyCut) {
  AxisDesign axis = braked_example();
  axis.braked->lag_s = {1, 1};
  const DesignReport report = design_axis(axis);
  ASSERT_FALSE(report.certified);
  EXPECT_TRUE(report.reasons.front().starts_with(
      "pulse_breaks_away: the least sure pulse against max_force_N: no finite number"))
      << report.reasons.front();
  EXPECT_NE(report.reasons.front().find("a faster current loop"), std::string::npos) << report.reasons.front();
  const double lag_s = number_after(report.reasons.front(), "current_loop_time_constant_s of ");
  axis.braked->lag_s = {lag_s, lag_s};
  EXPECT_TRUE(design_axis(axis).certified) << lag_s;
}

TEST(DesignReport, NamesTheLongestLagThatReachesTheTolerance) {
  for (const double told_s : {1e-3, 4e-3, 20e-3}) {
    AxisDesign axis = braked_example();
    axis.position_tolerance_m = 2.2e-6;
    const auto with_lag = [&](double lag_s) {
      axis.braked->lag_s = {0.8 * lag_s, 1.2 * lag_s};
      return design_axis(axis);
    };
    const DesignReport report = with_lag(told_s);
    ASSERT_FALSE(report.certified);
    const double lag_s = number_after(report.reasons.front(), "current_loop_time_constant_s of ");
    EXPECT_TRUE(with_lag(lag_s).certified) << lag_s;
    EXPECT_FALSE(with_lag(1.1 * lag_s).certified) << "the floor may fall a little with the lag, but not so much";
  }
}

// The pieces of a sentence that each name a way, as it may be typed.
std::vector<std::string> ways_in(const std::string& reason) {
  const std::string between = ", or ";
  std::vector<std::string> ways;
  std::size_t from = reason.find("; ");
  while (from < reason.size()) {
    const std::size_t next = std::min(reason.find(between, from + 1), reason.size());
    ways.push_back(reason.substr(from, next - from));
    from = next;
  }
  return ways;
}

// Types each number of a way into the design; false where it has none.
bool type(const std::string& way, AxisDesign& axis) {
  bool typed = false;
  const auto take = [&](const std::string& words, auto&& into) {
    if (way.find(words) == std::string::npos) return;
    into(number_after(way, words));
    typed = true;
  };
  BrakedClass& c = *axis.braked;
  const double share = (c.lag_s.most - c.lag_s.least) / (c.lag_s.most + c.lag_s.least);
  take("widen it to ", [&](double value) { axis.position_tolerance_m = value; });
  take("shorten period_s to ", [&](double value) { axis.period_s = c.period_s = value; });
  take("with a period_s of ", [&](double value) { axis.period_s = c.period_s = value; });
  take("encoder_resolution_m of ", [&](double value) { axis.encoder_resolution_m = c.encoder_resolution_m = value; });
  take("encoder_noise_m of ", [&](double value) { c.encoder_noise_m = value; });
  take("with steps of force of ", [&](double value) { c.force_step_N = value; });
  take("settle_tolerance_m = ", [&](double value) { axis.settle_tolerance_m = value; });
  take("current_loop_time_constant_s of ", [&](double value) { c.lag_s = {value * (1 - share), value * (1 + share)}; });
  const bool fine = c.fine_tolerance_m > 0 || way.find("fine stage") != std::string::npos;
  c.fine_tolerance_m = fine ? axis.position_tolerance_m : 0;
  return typed;
}

// A tolerance below what the axis has, by itself or behind a lag, whose limits are of one kind or another.
AxisDesign random_out_of_reach(std::mt19937_64& bits) {
  std::uniform_real_distribution<double> unit{0, 1};
  const auto decades = [&](double a, double b) { return a * std::pow(b / a, unit(bits)); };
  const auto one_in = [&](int n) { return unit(bits) * n < 1; };
  AxisDesign axis = braked_example();
  BrakedClass& c = *axis.braked;
  c.friction.upper_N = c.friction.lower_N * decades(1.02, 5);
  c.max_force_N = c.friction.upper_N * decades(1.5, 30);
  c.force_step_N = c.max_force_N / (one_in(4) ? decades(10, 60) : decades(100, 4000));
  c.encoder_resolution_m = axis.encoder_resolution_m = decades(1e-8, 1e-4);
  c.mass_kg = {1 - 0.1 * unit(bits), 1 + 0.1 * unit(bits)};
  if (one_in(2)) c.lag_s.most = decades(1e-5, 3e-2), c.lag_s.least = c.lag_s.most * (1 - 0.4 * unit(bits));
  if (one_in(4)) c.encoder_noise_m = c.encoder_resolution_m * decades(0.01, 3);
  if (one_in(5)) c.jitter_s = 0.3 * unit(bits) * c.period_s;
  if (one_in(5)) c.presliding_stiffness_N_per_m = c.friction.lower_N / (c.encoder_resolution_m * decades(1, 40));
  if (one_in(5)) c.move = MoveRequest{0.4, decades(0.05, 2), decades(5, 50), {}};
  if (one_in(6))
    c.spring_load =
        SpringLoad{0.4, 0.6, decades(1e6, 1e10), {1.3, 0.55 * c.friction.upper_N}, {1.2, 0.45 * c.friction.upper_N}};
  const double least_m = design_braked_kicks<float>(c).least_tolerance_m;
  axis.position_tolerance_m = (std::isfinite(least_m) && least_m > 0 ? least_m : 1e-5) * decades(0.02, 0.99);
  c.fine_tolerance_m = one_in(2) ? axis.position_tolerance_m : 0;
  axis.settle_tolerance_m = one_in(3) ? 1 : 0;
  axis.least_period_s = 1e-4;
  return axis;
}

// Where nothing else fails, every number that a refused tolerance is answered with is one with which it is certified.
TEST(DesignReport, IsCertifiedWithEachNumberThatItNames) {
  std::mt19937_64 bits{26};
  int answered = 0, refused = 0;
  for (long number = 0, axes = campaign::from_environment("BREAKAWAY_WAYS", 24); number < axes; ++number) {
    const AxisDesign axis = random_out_of_reach(bits);
    const DesignReport report = design_axis(axis);
    if (report.certified || report.reasons.size() > 1 || !report.reasons.front().starts_with("tolerance_above_floor"))
      continue;
    ++refused;
    for (const std::string& way : ways_in(report.reasons.front())) {
      AxisDesign typed = axis;
      if (!type(way, typed)) continue;
      ++answered;
      const DesignReport then = design_axis(typed);
      EXPECT_TRUE(then.certified) << "axis " << number << ": " << way << "\nof: " << report.reasons.front()
                                  << "\nand then: " << then.reasons.front();
    }
  }
  EXPECT_GT(refused, 8);
  EXPECT_GT(answered, 2 * refused);
}

}  // namespace
}  // namespace breakaway::design
