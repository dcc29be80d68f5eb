// An axis that knows where it stands only once somebody has said so: after a reboot of its drive, and by homing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
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

// The axis stands at -0.1 m of a machine with limit switches at -0.295 and 0.195 m, a home switch at 0.05 m and an
// index pulse every 10 mm. Where a method has its home switch on between two edges, the other one is at 0.07 m.
RigConfig with_switches(std::int8_t method) {
  RigConfig config;
  config.absolute_encoder = false;
  config.quirks.switches = {.low_limit_m = -0.295, .high_limit_m = 0.195, .home_m = 0.05, .index_distance_m = 0.01};
  config.homing = {.home = cia402::Home::by_drive,
                   .position_counts = 20'000,
                   .method = method,
                   .search_counts_s = 200'000,
                   .zero_counts_s = 20'000,
                   .acceleration_counts_s2 = 5'000'000,
                   .timeout = 20s};
  return config;
}

struct MethodAndHome {
  std::int8_t method;
  double start_m, home_m;
};
class AHomingThatMoves : public ::testing::TestWithParam<MethodAndHome> {};

// Home is 20 mm, wherever that is in the machine; the switch is seen once in half a millisecond.
TEST_P(AHomingThatMoves, BringsTheAxisToItsZeroAndThenToItsTarget) {
  RigConfig config = with_switches(GetParam().method);
  config.start_m = GetParam().start_m;
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  double largest_N = 0;
  while (!rig.status(0).running && rig.status(0).fault == AxisFault::none && rig.now() < hal::Time{30s}) {
    rig.step();
    rig.release_brakes_while_homing();
    largest_N = std::max(largest_N, std::abs(rig.force_N(0)));
  }
  ASSERT_TRUE(rig.status(0).running) << to_string(rig.status(0).fault);
  EXPECT_GT(largest_N, 4.5) << "the drive moved it";
  EXPECT_LE(largest_N, 50.0);
  rig.run(3s);
  EXPECT_EQ(rig.status(0).fault, AxisFault::none) << to_string(rig.status(0).fault);
  EXPECT_NEAR(rig.position_m(0), GetParam().home_m - 0.02, 2e-5) << "target 0";
}
INSTANTIATE_TEST_SUITE_P(
    Methods, AHomingThatMoves,
    ::testing::Values(MethodAndHome{1, -0.1, -0.29}, MethodAndHome{2, -0.1, 0.19}, MethodAndHome{17, -0.1, -0.295},
                      MethodAndHome{18, -0.1, 0.195}, MethodAndHome{19, -0.1, 0.05}, MethodAndHome{19, 0.1, 0.05},
                      MethodAndHome{20, -0.1, 0.05}, MethodAndHome{20, 0.1, 0.05}, MethodAndHome{21, -0.1, 0.05},
                      MethodAndHome{21, 0.1, 0.05}, MethodAndHome{22, -0.1, 0.05}, MethodAndHome{22, 0.1, 0.05},
                      MethodAndHome{33, -0.105, -0.11}, MethodAndHome{34, -0.105, -0.1}),
    [](const auto& param_info) {
      return std::to_string(param_info.param.method) + (param_info.param.start_m > 0 ? "FromAbove" : "FromBelow");
    });

struct MethodAndPlace {
  std::int8_t method;
  double home_m;
};
class AHomingByAnEdge : public ::testing::TestWithParam<MethodAndPlace> {};

// The edge is at 0.053 m, and a second one, where there is one, at 0.073 m: each a way off the next index pulse either
// side. From below, from above and from the switch the home is one.
TEST_P(AHomingByAnEdge, EndsAtTheSameHomeFromEverywhere) {
  for (const double start_m : {-0.1, 0.063, 0.12}) {
    RigConfig config = with_switches(GetParam().method);
    config.quirks.switches->home_m = 0.053;
    config.start_m = start_m;
    Rig rig{config};
    rig.loop().request_enable(rig.id(0));
    while (!rig.status(0).running && rig.status(0).fault == AxisFault::none && rig.now() < hal::Time{30s}) {
      rig.step();
      rig.release_brakes_while_homing();
    }
    ASSERT_TRUE(rig.status(0).running) << start_m << ": " << to_string(rig.status(0).fault);
    rig.run(3s);
    EXPECT_EQ(rig.status(0).fault, AxisFault::none) << start_m << ": " << to_string(rig.status(0).fault);
    EXPECT_NEAR(rig.position_m(0), GetParam().home_m - 0.02, 2e-5) << "target 0, from " << start_m;
  }
}
INSTANTIATE_TEST_SUITE_P(Methods, AHomingByAnEdge,
                         ::testing::Values(MethodAndPlace{3, 0.05}, MethodAndPlace{4, 0.06}, MethodAndPlace{5, 0.06},
                                           MethodAndPlace{6, 0.05}, MethodAndPlace{7, 0.05}, MethodAndPlace{8, 0.06},
                                           MethodAndPlace{9, 0.07}, MethodAndPlace{10, 0.08}, MethodAndPlace{11, 0.08},
                                           MethodAndPlace{12, 0.07}, MethodAndPlace{13, 0.06}, MethodAndPlace{14, 0.05},
                                           MethodAndPlace{23, 0.053}, MethodAndPlace{24, 0.053},
                                           MethodAndPlace{25, 0.073}, MethodAndPlace{26, 0.073},
                                           MethodAndPlace{27, 0.073}, MethodAndPlace{28, 0.073},
                                           MethodAndPlace{29, 0.053}, MethodAndPlace{30, 0.053}),
                         [](const auto& param_info) { return std::to_string(param_info.param.method); });

// Seeks its home at full speed, and returns what the axis is named by, within so long.
AxisFault named_while_it_moves(Rig& rig, const std::function<void(Rig&)>& disturb, hal::Duration within) {
  rig.loop().request_enable(rig.id(0));
  const auto step = [&rig] {
    rig.step();
    rig.release_brakes_while_homing();
  };
  while (std::abs(rig.slide(0).state().velocity_m_s) < 0.15 && rig.now() < hal::Time{10s}) step();
  EXPECT_GE(std::abs(rig.slide(0).state().velocity_m_s), 0.15) << "it moves";
  disturb(rig);
  for (const hal::Time end = rig.now() + within; rig.now() < end && rig.status(0).fault == AxisFault::none;) step();
  const AxisFault fault = rig.status(0).fault;
  rig.run(30ms);
  EXPECT_LT(std::abs(rig.force_N(0)), 0.1) << to_string(fault);
  rig.run(500ms);
  EXPECT_TRUE(rig.slide(0).sticking()) << to_string(fault);
  return fault;
}

TEST(Reference, AHomingThatMovesIsStoppedByName) {
  const auto nothing = [](Rig&) {};
  RigConfig no_switch = with_switches(17);
  no_switch.quirks.switches->low_limit_m = -HUGE_VAL;
  no_switch.homing.timeout = 2s;
  {
    Rig rig{no_switch};
    EXPECT_EQ(named_while_it_moves(rig, nothing, 3s), AxisFault::homing_failed) << "time is up";
  }
  no_switch.homing.timeout = 20s;
  no_switch.quirks.homing_gives_up_after = 1s;
  {
    Rig rig{no_switch};
    EXPECT_EQ(named_while_it_moves(rig, nothing, 2s), AxisFault::homing_failed) << "the drive tells of an error";
  }
  const auto named = [](const std::function<void(Rig&)>& disturb, hal::Duration within) {
    Rig rig{with_switches(17)};
    return named_while_it_moves(rig, disturb, within);
  };
  EXPECT_EQ(named([](Rig& r) { r.drive(0).trip_fault(0x8611, r.now()); }, 5ms), AxisFault::emergency);
  EXPECT_EQ(named([](Rig& r) { r.drive(0).suppress_heartbeat(true); }, 300ms), AxisFault::heartbeat_lost);
  EXPECT_EQ(named([](Rig& r) { r.drive(0).inhibit_beyond(cia402::State::switch_on_disabled, r.now()); }, 300ms),
            AxisFault::homing_failed);
  {
    RigConfig config = with_switches(17);
    config.homing.timeout = 2s;
    Rig rig{config};
    EXPECT_EQ(named_while_it_moves(
                  rig, [](Rig& r) { r.write_to_drive(0x6060, 0, 0, 1); }, 3s),
              AxisFault::homing_failed)
        << "another tool took the mode away";
  }
}

TEST(Reference, AStopEndsAHomingThatMoves) {
  Rig rig{with_switches(17)};
  EXPECT_EQ(named_while_it_moves(
                rig, [](Rig& r) { r.loop().request_stop(r.id(0)); }, 100ms),
            AxisFault::none);
  EXPECT_FALSE(rig.status(0).running);
}

TEST(Reference, AHomingThatRunsAwayIsNamedByItsSpeed) {
  RigConfig config = with_switches(17);
  config.limits.speed_m_s = 0.16F;
  Rig rig{config};
  rig.loop().request_enable(rig.id(0));
  double fastest_m_s = 0;
  for (int i = 0; i < 5000 && rig.status(0).fault == AxisFault::none; ++i) {
    rig.step();
    rig.release_brakes_while_homing();
    fastest_m_s = std::max(fastest_m_s, std::abs(rig.slide(0).state().velocity_m_s));
  }
  EXPECT_EQ(rig.status(0).fault, AxisFault::speed_limit) << to_string(rig.status(0).fault);
  EXPECT_LT(fastest_m_s, 0.19) << "within four samples of it";
}

// The brake of the rig stays closed, so that the drive pushes against it.
TEST(Reference, AnAxisThatDoesNotMoveUnderTheForceOfAHomingIsNamed) {
  Rig rig{with_switches(17)};
  rig.loop().request_enable(rig.id(0));
  hal::Time pushed{};
  for (int i = 0; i < 5000 && rig.status(0).fault == AxisFault::none; ++i) {
    rig.step();
    if (pushed == hal::Time{} && std::abs(rig.force_N(0)) > 4.6) pushed = rig.now();
  }
  EXPECT_EQ(rig.status(0).fault, AxisFault::no_motion_under_force) << to_string(rig.status(0).fault);
  EXPECT_LE(rig.now() - pushed, 30ms);
}

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
