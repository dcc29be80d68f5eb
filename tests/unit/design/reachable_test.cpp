// What is said of a tolerance that is out of reach.
#include "../../../controller/design/src/reachable.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>

namespace breakaway::design {
namespace {

BrakedClass counted_axes() {
  BrakedClass c;
  c.friction = {2.5, 4.5};
  c.max_force_N = 50;
  c.force_step_N = 0.025;
  c.period_s = 1e-3;
  c.encoder_resolution_m = 1e-6;
  return c;
}

std::string ways(const BrakedClass& c, double tolerance_m) {
  return detail::ways_to_reach(c, design_braked_kicks<float>(c), tolerance_m);
}

TEST(WaysToReach, NameLessNoiseWhereNoCountOfAnEncoderWouldDo) {
  BrakedClass c = counted_axes();
  c.encoder_noise_m = 1e-6;
  const std::string said = ways(c, 1e-6);
  EXPECT_TRUE(said.starts_with("widen it to ")) << said;
  EXPECT_TRUE(said.ends_with(" m, or take an encoder with less noise")) << said;
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
    EXPECT_NE(said.find(", or have the fine stage aim at it"), std::string::npos) << said;
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

// The instants of the loop may be off by half a period at most.
TEST(WaysToReach, NameNoPeriodOfWhichTheJitterIsMoreThanHalf) {
  BrakedClass c = counted_axes();
  EXPECT_NE(ways(c, 1.2e-6).find("or shorten period_s to "), std::string::npos) << ways(c, 1.2e-6);
  c.jitter_s = 0.45e-3;
  EXPECT_EQ(ways(c, 1.2e-6).find("period_s"), std::string::npos) << ways(c, 1.2e-6);
}

}  // namespace
}  // namespace breakaway::design
