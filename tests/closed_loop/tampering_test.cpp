// What another tool does to a drive before, while and after it is set up: no force stays on, and every end has a name
// and a way out.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;

void expect_at_target(Rig& rig) {
  rig.run(5s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_LE(std::abs(rig.position_m(0)), 3e-6);
}

TEST(Tampering, ADriveThatIsFoundWithForceLosesItInTheFirstPeriods) {
  Rig rig{{}};
  rig.run(6ms);  // it has booted, and nothing more
  enable_from_elsewhere(rig);
  rig.run(5ms);
  EXPECT_GT(rig.drive(0).largest_force_N(rig.now()), 5) << "there was no force to take off";
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
  ASSERT_TRUE(rig.start());
  expect_at_target(rig);
}

// Whatever the set-up is at when it happens.
TEST(Tampering, ADriveThatIsEnabledFromElsewhereWhileItIsSetUpLosesItsForceAndRunsAfterAReset) {
  int onsets = 0;
  for (hal::Duration onset = 6ms; onset < 400ms; onset += 7ms, ++onsets) {
    Rig rig{{}};
    rig.run(onset);
    if (rig.status(0).feedback.state == hal::DriveState::disabled) break;
    enable_from_elsewhere(rig);
    ASSERT_EQ(rig.drive(0).state(), cia402::State::operation_enabled);
    rig.run(60ms);
    EXPECT_GT(rig.drive(0).largest_force_N(rig.now()), 5) << "there was no force to take off";
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << onset.count() << " ns";
    EXPECT_LT(rig.largest_force_N(0, 500ms), 0.1) << "it stays off";
    if (rig.status(0).fault != AxisFault::none) {
      EXPECT_EQ(rig.status(0).fault, AxisFault::stop_not_obeyed);
      EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
    }
    ASSERT_TRUE(rig.start());
    expect_at_target(rig);
  }
  EXPECT_GE(onsets, 5) << "the set-up was over too soon to be disturbed";
}

// A transfer a period is for the set-ups of all of them.
TEST(Tampering, OneOfEightDrivesThatIsEnabledWhileTheyAreSetUpLosesItsForceAfterAsManyTurns) {
  for (const auto& [period, limit] : {std::pair{1ms, 200ms}, std::pair{10ms, 2000ms}}) {
    hal::Duration longest{};
    int onsets = 0;
    for (hal::Duration onset = 10ms; onsets < 60; onset += 3 * period + period * (onsets % 7), ++onsets) {
      RigConfig config;
      config.period = period;
      config.axes = 8;
      Rig rig{config};
      rig.run(onset);
      const std::size_t axis = static_cast<std::size_t>(onsets) % config.axes;
      if (rig.status(axis).feedback.state == hal::DriveState::disabled) break;
      enable_from_elsewhere(rig, axis);
      const hal::Time begin = rig.now();
      while (std::abs(rig.force_N(axis)) > 0.1 || rig.now() - begin < 3 * period) {
        ASSERT_LE(rig.now() - begin, limit) << onset / 1ms << " ms";
        rig.step();
      }
      longest = std::max(longest, rig.now() - begin);
      EXPECT_LT(rig.largest_force_N(axis, 50 * period), 0.1) << "it stays off";
    }
    EXPECT_GE(onsets, 50) << "the set-up was over too soon to be disturbed";
    EXPECT_GT(longest, limit / 2) << "the limit says something";
  }
}

struct Obstacle {
  const char* label;
  std::uint16_t index;
  std::uint8_t subindex;
  std::uint32_t value;
  std::uint8_t bytes;
};
constexpr Obstacle obstacles[] = {
    {"RpdoOff", 0x1400, 1, 0x80000201, 4}, {"TpdoOff", 0x1800, 1, 0xC0000181, 4}, {"AnotherSync", 0x1005, 0, 0x81, 4}};

class AfterTampering : public ::testing::TestWithParam<Obstacle> {
 protected:
  static void tamper(Rig& rig) {
    const Obstacle& o = GetParam();
    rig.write_to_drive(o.index, o.subindex, o.value, o.bytes);
  }
};

// What does not answer SYNC any more is set up anew by itself.
TEST_P(AfterTampering, ADriveThatCannotBeEnabledIsSetUpAnewOrNamedAndThenRunsAfterAReset) {
  Rig rig{{}};
  while (rig.status(0).feedback.state != hal::DriveState::disabled) rig.step();
  tamper(rig);
  rig.loop().request_enable(rig.id(0));
  if (GetParam().index == 0x1400) {
    rig.run(5100ms);
    EXPECT_EQ(rig.status(0).fault, AxisFault::enable_timed_out) << to_string(rig.status(0).fault);
    EXPECT_LT(std::abs(rig.force_N(0)), 0.1);
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  }
  ASSERT_TRUE(rig.start());
  expect_at_target(rig);
}

// Its last statusword was harmless, and none comes after it.
TEST(Tampering, ADriveThatIsEnabledAfterItsTpdoWasSwitchedOffLosesItsForce) {
  Rig rig{{}};
  while (rig.status(0).feedback.state != hal::DriveState::disabled) rig.step();
  rig.write_to_drive(0x1800, 1, 0xC0000181, 4);
  rig.write_to_drive(0x1400, 1, 0x80000201, 4);
  enable_from_elsewhere(rig);
  rig.run(50ms);
  EXPECT_GT(rig.drive(0).largest_force_N(rig.now()), 5) << "there was no force to take off";
  EXPECT_LT(rig.largest_force_N(0, 500ms), 0.1);
  rig.loop().reset_fault(rig.id(0));
  ASSERT_TRUE(rig.start());
  expect_at_target(rig);
}

TEST_P(AfterTampering, AFaultOfTheDriveIsResetAllTheSame) {
  Rig rig{{}};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.drive(0).trip_fault(0x2310, rig.now());
  rig.run(20ms);
  ASSERT_EQ(rig.status(0).fault, AxisFault::emergency);
  tamper(rig);
  rig.run(2s);
  EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  expect_at_target(rig);
}

INSTANTIATE_TEST_SUITE_P(Of, AfterTampering, ::testing::ValuesIn(obstacles),
                         [](const auto& row) { return std::string{row.param.label}; });

TEST(Tampering, AnotherModeOfOperationIsMendedByAReset) {
  Rig rig{{.start_m = -1}};
  ASSERT_TRUE(rig.start());
  rig.run(20ms);
  rig.drive(0).trip_fault(0x2310, rig.now());
  rig.run(20ms);
  rig.write_to_drive(0x6060, 0, 0, 1);
  rig.run(100ms);
  EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  expect_at_target(rig);
}

TEST(Tampering, AnOffsetOfTheTorqueIsTakenAwayBeforeTheDriveIsEnabled) {
  Rig rig{{}};
  rig.run(6ms);
  rig.write_to_drive(0x60B2, 0, 600, 2);
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.drive(0).objects().get({0x60B2, 0}), 0);
  EXPECT_EQ(rig.drive(0).objects().get({0x605A, 0}), 0) << "a stop is without force at once";
  EXPECT_EQ(rig.drive(0).objects().get({0x605E, 0}), 0);
  expect_at_target(rig);
}

// 10 N of 25 N rated: whatever is added to the command, the drive's own limit bounds the sum.
TEST(Tampering, TheDrivesOwnLimitBoundsForceThatAnotherToolAdds) {
  Rig rig{{.start_m = -1, .max_force_N = 10}};
  ASSERT_TRUE(rig.start());
  EXPECT_EQ(rig.drive(0).objects().get({0x6072, 0}), 400);
  rig.run(20ms);
  rig.write_to_drive(0x60B2, 0, 600, 2);
  EXPECT_LE(rig.largest_force_N(0, 500ms), 10.001);
}

TEST(Wrap, AnAxisGoesAcrossTheEndOfTheCountersRangeUnderEveryLimit) {
  constexpr double end_m = 2147.483648;
  for (const double sign : {1.0, -1.0}) {
    RigConfig config;
    config.start_m = sign * (end_m - 0.05);
    config.limits.speed_m_s = 6;
    config.limits.following_error_m = 0.02F;
    Rig rig{config};
    constexpr auto highest = std::numeric_limits<std::int32_t>::max();
    constexpr auto lowest = std::numeric_limits<std::int32_t>::min();
    rig.loop().set_target_counts(rig.id(0), sign > 0 ? highest - 50'000 : lowest + 50'000);
    ASSERT_TRUE(rig.start());
    rig.run(1s);
    rig.loop().set_target_counts(rig.id(0), sign > 0 ? lowest + 50'000 : highest - 50'000);
    double furthest_m = 0;
    for (int i = 0; i < 3000; ++i) {
      rig.step();
      furthest_m = std::max(furthest_m, std::abs(rig.position_m(0)));
    }
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
    EXPECT_NEAR(rig.position_m(0), sign * (end_m + 0.05), 5e-6);
    EXPECT_LE(furthest_m, end_m + 0.0501);
  }
}

}  // namespace
}  // namespace breakaway::closed_loop
