// An axis that knows where it stands only once somebody has said so: after a reboot of its drive, and by homing.
#include <gtest/gtest.h>

#include <string>

#include "rig.hpp"

namespace breakaway::closed_loop {
namespace {

using firmware::AxisFault;

// A reset alone moves nothing, because nobody knows where to.
TEST(Reference, AnIncrementalAxisWhoseDriveRebootedWaitsUntilItIsToldWhereItStands) {
  auto config = far_from_target();
  config.absolute_encoder = false;
  Rig rig{config};
  while (!rig.status(0).feedback.ever_valid) rig.step();
  ASSERT_TRUE(rig.loop().set_reference_counts(rig.id(0), -1'000'000));
  ASSERT_TRUE(rig.start());
  rig.run(4s);
  ASSERT_LE(std::abs(rig.position_m(0)), 4e-6);
  EXPECT_FALSE(rig.loop().set_reference_counts(rig.id(0), 5)) << "it runs";
  rig.drive(0).power_off(rig.now());
  rig.drive(0).power_on(rig.now());
  rig.run(1s);
  ASSERT_NE(rig.status(0).fault, AxisFault::none);
  rig.loop().set_target_m(rig.id(0), 0.1F);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
    EXPECT_LT(rig.largest_force_N(0, 1s), 0.1);
    EXPECT_EQ(rig.status(0).fault, AxisFault::reference_lost) << to_string(rig.status(0).fault);
  }
  EXPECT_TRUE(rig.loop().set_reference_counts(rig.id(0), 0));
  EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.run(4s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), 0.1, 6e-6);
}

struct HomeInFile {
  const char* label;
  cia402::Home home;
};
class AnIncrementalAxisWithAHome : public ::testing::TestWithParam<HomeInFile> {};

// Where it stands is 0.25 m, whatever its drive counts.
TEST_P(AnIncrementalAxisWithAHome, GetsItsZeroAtTheStartAndAfterAResetThatAcknowledgesItsLoss) {
  auto config = far_from_target();
  config.absolute_encoder = false;
  config.homing = {.home = GetParam().home, .position_counts = 250'000};
  Rig rig{config};
  ASSERT_TRUE(rig.start()) << to_string(rig.status(0).fault);
  rig.run(4s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), -1.25, 6e-6);
  rig.drive(0).power_off(rig.now());
  rig.drive(0).power_on(rig.now());
  rig.run(1s);
  ASSERT_NE(rig.status(0).fault, AxisFault::none);
  ASSERT_TRUE(rig.loop().reset_fault(rig.id(0)));
  rig.run(4s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), -1.5, 1e-5);
  EXPECT_TRUE(rig.status(0).running);
}
INSTANTIATE_TEST_SUITE_P(Homes, AnIncrementalAxisWithAHome,
                         ::testing::Values(HomeInFile{"Here", cia402::Home::here},
                                           HomeInFile{"ByDrive", cia402::Home::by_drive}),
                         [](const auto& param_info) { return std::string{param_info.param.label}; });

TEST(Reference, AHomingThatFailsIsNamedAndTriedAgainAfterAReset) {
  RigConfig config;
  config.absolute_encoder = false;
  config.homing = {.home = cia402::Home::by_drive};
  config.quirks.homing_fails = true;
  Rig rig{config};
  EXPECT_FALSE(rig.start());
  EXPECT_EQ(rig.status(0).fault, AxisFault::homing_failed) << to_string(rig.status(0).fault);
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(rig.loop().reset_fault(rig.id(0)));
    rig.run(20ms);
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
    rig.run(1s);
    EXPECT_EQ(rig.status(0).fault, AxisFault::homing_failed) << to_string(rig.status(0).fault);
  }
}

TEST(Reference, AnAxisIsWatchedWhileItsDriveFindsItsHome) {
  RigConfig config;
  config.absolute_encoder = false;
  config.homing = {.home = cia402::Home::by_drive};
  config.quirks.mode_display_delay = 200ms;  // of each mode, so that there is time to interfere
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  const auto homing = [&] { return rig.status(0).feedback.state == hal::DriveState::homing; };
  while (!homing() && rig.now() < hal::Time{5s}) rig.step();
  ASSERT_TRUE(homing());
  rig.run(50ms);
  EXPECT_FALSE(rig.loop().reset_fault(rig.id(0))) << "it may have force";
  rig.drive(0).trip_fault(0x4210, rig.now());
  steps_until_fault(rig, 3);
  EXPECT_EQ(rig.status(0).fault, AxisFault::emergency) << to_string(rig.status(0).fault);
}

}  // namespace
}  // namespace breakaway::closed_loop
