// Which numbers of a coordinator are usable.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>

#include "coordinator_fixture.hpp"

namespace breakaway::law::coordinator_test {
namespace {

TEST(CoordinatorNumbers, AreUsableWithinTheirRangesOnly) {
  using Axis = CoordinatedAxisParameters<double, 4>;
  constexpr double least = std::numeric_limits<double>::min(), most = std::numeric_limits<double>::max();
  constexpr double infinite = std::numeric_limits<double>::infinity();
  struct Range {
    const char* name;
    double Axis::*number;
    double least, most;
  };
  const Range ranges[] = {{"P", &Axis::position_gain_N_per_m, 0, most},
                          {"D", &Axis::velocity_gain_Ns_per_m, 0, most},
                          {"mass", &Axis::mass_kg, least, most},
                          {"lower friction", &Axis::lower_N, std::nextafter(0.5, 1), 4.5},
                          {"upper friction", &Axis::upper_N, 2.5, 4.51},
                          {"sure force", &Axis::sure_N, 4.5, most},
                          {"brake", &Axis::brake_N, 0, std::nextafter(2.5, 0)},
                          {"largest force", &Axis::max_force_N, least, most},
                          {"gate", &Axis::gate_m, least, most},
                          {"tolerance", &Axis::tolerance_m, least, most},
                          {"resolution", &Axis::resolution_m, least, most}};
  Parameters sound = two_axes();
  ASSERT_TRUE(are_usable(sound));
  for (auto& axis : sound.axes) axis.kick_N = 0;
  for (const Range& range : ranges) {
    for (const std::size_t axis : {0UL, 1UL}) {
      const auto usable_at = [&](double value) {
        Parameters p = sound;
        p.axes[axis].*range.number = value;
        return are_usable(p);
      };
      EXPECT_TRUE(usable_at(range.least)) << range.name;
      EXPECT_TRUE(usable_at(range.most)) << range.name;
      EXPECT_FALSE(usable_at(std::nextafter(range.least, -infinite))) << range.name;
      EXPECT_FALSE(usable_at(std::nextafter(range.most, infinite))) << range.name;
      EXPECT_FALSE(usable_at(nan)) << range.name;
    }
  }
  sound.axes[2].mass_kg = -1;
  EXPECT_TRUE(are_usable(sound)) << "is not there";
}

TEST(CoordinatorNumbers, AKickIsNoneOrSureAndWithinTheDrive) {
  Parameters p = two_axes();
  const auto usable_at = [&](double kick_N) {
    p.axes[0].kick_N = kick_N;
    return are_usable(p);
  };
  EXPECT_TRUE(usable_at(0));
  EXPECT_TRUE(usable_at(4.51));
  EXPECT_TRUE(usable_at(50));
  EXPECT_FALSE(usable_at(std::nextafter(4.51, 0)));
  EXPECT_FALSE(usable_at(std::nextafter(50, 60)));
  EXPECT_FALSE(usable_at(nan));
}

TEST(CoordinatorNumbers, EveryDriveGivesWhatKicksOfTheOthersAskOfIt) {
  constexpr double digit = std::numeric_limits<double>::epsilon();
  Parameters p = two_axes();
  p.axes[1].kick_N = 0;
  p.axes[1].max_force_N = 1;
  p.axes[0].lower_N = p.axes[0].upper_N = p.axes[0].sure_N = 1;
  const auto usable_with = [&](double kick_N, double share) {
    p.axes[0].kick_N = kick_N;
    p.axes[0].hold_off[1] = share;
    return are_usable(p);
  };
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(usable_with(2, side * (1 + 8 * digit))) << "in the pulse, but for its rounding";
    EXPECT_FALSE(usable_with(2, side * (1 + 9 * digit)));
    EXPECT_TRUE(usable_with(1, side * 1.3)) << "in the coast (1 + 0.5)/2";
    EXPECT_FALSE(usable_with(1, side * 1.4));
    EXPECT_TRUE(usable_with(0, side * 100)) << "it is never kicked";
    EXPECT_TRUE(usable_with(1, 0));
    p.axes[0].hold_off[0] = side * 0.1;
    EXPECT_FALSE(are_usable(p)) << "of itself";
    p.axes[0].hold_off[0] = 0;
  }
  p.axes[0].hold_off[2] = 1e9;
  EXPECT_TRUE(are_usable(p)) << "of an axis that is not there";
}

TEST(CoordinatorNumbers, PeriodsAndAxesAreCountedFromOne) {
  const auto usable_with = [](auto change) {
    Parameters p = two_axes();
    p.axes[2] = p.axes[3] = p.axes[1];
    change(p);
    return are_usable(p);
  };
  constexpr double most = std::numeric_limits<double>::max();
  EXPECT_TRUE(usable_with([](Parameters& p) { p.period_s = most; }));
  EXPECT_TRUE(usable_with([](Parameters& p) { p.period_s = std::numeric_limits<double>::denorm_min(); }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.period_s = 2 * most; }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.period_s = 0; }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.period_s = nan; }));
  EXPECT_TRUE(usable_with([](Parameters& p) { p.count = 1; }));
  EXPECT_TRUE(usable_with([](Parameters& p) { p.count = 4; }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.count = 0; }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.count = 5; }));
  EXPECT_TRUE(usable_with([](Parameters& p) { p.settling_periods = p.still_periods = 1; }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.settling_periods = 0; }));
  EXPECT_FALSE(usable_with([](Parameters& p) { p.still_periods = 0; }));
}

}  // namespace
}  // namespace breakaway::law::coordinator_test
