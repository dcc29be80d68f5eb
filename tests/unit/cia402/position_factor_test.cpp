#include "breakaway/cia402/position_factor.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace {

using breakaway::canopen::ObjectAddress;
using breakaway::cia402::PositionFactor;

struct Shown {
  ObjectAddress object;
  std::uint32_t value;
};

PositionFactor factor_of(const std::vector<Shown>& objects) {
  PositionFactor factor;
  for (const auto& [object, value] : objects) factor.note(object, value);
  return factor;
}

TEST(PositionFactor, IsTheQuotientOfTheProfile) {
  // 4096 counts a turn of the motor, 5 turns of the motor in 2 of the shaft, 3000 units in 4 turns of the shaft.
  const PositionFactor factor = factor_of({{{0x608F, 1}, 4096},
                                           {{0x608F, 2}, 1},
                                           {{0x6091, 1}, 5},
                                           {{0x6091, 2}, 2},
                                           {{0x6092, 1}, 3000},
                                           {{0x6092, 2}, 4}});
  EXPECT_FLOAT_EQ(factor.units_per_count(), 3000.0F / 4 / 4096 * 2 / 5);
  EXPECT_FALSE(factor.is_one_to_one());
  EXPECT_FALSE(factor.is_finer_than_encoder());
}

TEST(PositionFactor, IsOneForADriveThatHasNoneAndForOneThatShowsZeros) {
  EXPECT_TRUE(factor_of({}).is_one_to_one());
  EXPECT_TRUE(factor_of({{{0x608F, 1}, 0}, {{0x6091, 1}, 0}, {{0x6092, 1}, 0}}).is_one_to_one());
}

TEST(PositionFactor, IsOneWhereItCancelsHoweverLargeTheNumbersAre) {
  EXPECT_TRUE(factor_of({{{0x608F, 1}, 0xFFFF'FFFF},
                         {{0x608F, 2}, 7},
                         {{0x6091, 1}, 3},
                         {{0x6091, 2}, 0xFFFF'FFFF},
                         {{0x6092, 1}, 3},
                         {{0x6092, 2}, 7}})
                  .is_one_to_one());
}

TEST(PositionFactor, AResolutionWithoutAFeedConstantSaysNothingNorTheOtherWayRound) {
  EXPECT_TRUE(factor_of({{{0x608F, 1}, 131072}, {{0x608F, 2}, 1}}).is_one_to_one());
  EXPECT_TRUE(factor_of({{{0x6092, 1}, 131072}, {{0x6092, 2}, 1}}).is_one_to_one());
}

TEST(PositionFactor, OtherSubIndicesOfItsObjectsAreNoPartOfIt) {
  EXPECT_FLOAT_EQ(factor_of({{{0x6091, 1}, 10}, {{0x6091, 0}, 2}, {{0x6091, 3}, 7}}).units_per_count(), 0.1F);
}

TEST(PositionFactor, AGearAloneScales) {
  EXPECT_FLOAT_EQ(factor_of({{{0x6091, 1}, 10}, {{0x6091, 2}, 1}}).units_per_count(), 0.1F);
  EXPECT_TRUE(factor_of({{{0x6091, 2}, 10}, {{0x6091, 1}, 1}}).is_finer_than_encoder());
}

TEST(PositionFactor, TellsAMillionthFromOne) {
  const auto with_feed = [](std::uint32_t feed) { return factor_of({{{0x608F, 1}, 1'000'000}, {{0x6092, 1}, feed}}); };
  EXPECT_TRUE(with_feed(1'000'000).is_one_to_one());
  EXPECT_FALSE(with_feed(1'000'002).is_one_to_one());
  EXPECT_TRUE(with_feed(1'000'002).is_finer_than_encoder());
  EXPECT_FALSE(with_feed(999'998).is_one_to_one());
  EXPECT_FALSE(with_feed(999'998).is_finer_than_encoder());
}

}  // namespace
