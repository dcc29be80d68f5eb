#include "breakaway/hal/bus_load.hpp"

#include <gtest/gtest.h>

namespace {

using namespace std::chrono_literals;
using namespace breakaway::hal;

constexpr CanFrame frame{.id = 0x181, .size = 8, .data = {1, 2, 3, 4, 5, 6, 7, 8}};

TEST(BusLoad, IsTheShareOfTheBitsInTheLastWholeWindow) {
  BusLoad load{500'000};
  for (int n = 0; n < 100; ++n) load.add(frame, Time{n * 1ms});
  EXPECT_EQ(load.share(Time{99ms}), 0) << "no window is whole yet";
  EXPECT_NEAR(load.share(Time{100ms}), 100.0 * wire_bits(frame) / (500'000 * 0.1), 1e-9);
  EXPECT_NEAR(load.share(Time{199ms}), 100.0 * wire_bits(frame) / (500'000 * 0.1), 1e-9);
}

TEST(BusLoad, FallsToNothingWhenTheBusFallsSilent) {
  BusLoad load{500'000};
  for (int n = 0; n < 100; ++n) load.add(frame, Time{n * 1ms});
  EXPECT_GT(load.share(Time{150ms}), 0);
  EXPECT_EQ(load.share(Time{250ms}), 0);
}

TEST(BusLoad, EachWindowCountsItsOwnFrames) {
  BusLoad load{500'000};
  for (int n = 0; n < 130; ++n) load.add(frame, Time{n * 1ms});
  EXPECT_NEAR(load.share(Time{200ms}), 30.0 * wire_bits(frame) / (500'000 * 0.1), 1e-9);
}

TEST(BusLoad, IsThatOfTheLastWindowAlsoWhereNobodyAskedBefore) {
  for (const auto later : {200ms, 250ms, 290ms}) {
    BusLoad load{500'000};
    for (int n = 0; n < 100; ++n) load.add(frame, Time{n * 1ms});
    EXPECT_EQ(load.share(Time{later}), 0) << later.count();
  }
}

TEST(BusLoad, ForgetsAWindowThatLiesFurtherBackThanTheLast) {
  BusLoad load{500'000};
  load.add(frame, Time{0ms});
  EXPECT_EQ(load.share(Time{10s}), 0);
  load.add(frame, Time{10s});
  EXPECT_NEAR(load.share(Time{10s + 100ms}), wire_bits(frame) / (500'000 * 0.1), 1e-9);
}

}  // namespace
