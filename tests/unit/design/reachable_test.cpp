// What is said of a tolerance that is out of reach.
#include "../../../controller/design/src/reachable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>

#include "../number_after.hpp"

namespace breakaway::design {
namespace {

using testing::number_after;

BrakedClass counted_axes() {
  BrakedClass c;
  c.friction = {2.5, 4.5};
  c.max_force_N = 50;
  c.force_step_N = 0.025;
  c.period_s = 1e-3;
  c.encoder_resolution_m = 1e-6;
  return c;
}

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
  EXPECT_TRUE(said.ends_with(" m, or take an encoder with less noise")) << said;
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

}  // namespace
}  // namespace breakaway::design
