#include "breakaway/cia402/drive_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace std::chrono_literals;
using namespace breakaway::cia402;
using breakaway::hal::AxisScale;
using breakaway::hal::Duration;
using breakaway::hal::NetworkConfig;

TEST(InterpolationPeriod, WholeMillisecondsUseExponentMinusThree) {
  for (int ms = 1; ms <= 255; ++ms) {
    const auto period = interpolation_period(std::chrono::milliseconds{ms});
    ASSERT_TRUE(period.has_value());
    EXPECT_EQ(period->units, ms);
    EXPECT_EQ(period->exponent, -3);
  }
}

TEST(InterpolationPeriod, IsExactOrNothing) {
  unsigned found = 0;
  for (int us = 1; us <= 20'000; ++us) {
    const auto period = interpolation_period(std::chrono::microseconds{us});
    if (!period) continue;
    ++found;
    EXPECT_NEAR(period->units * std::pow(10.0, period->exponent), us * 1e-6, 1e-15) << us;
  }
  EXPECT_GT(found, 255U);
  EXPECT_FALSE(interpolation_period(1111us).has_value());
  EXPECT_FALSE(interpolation_period(0us).has_value());
  EXPECT_FALSE(interpolation_period(-1ms).has_value());
  EXPECT_FALSE(interpolation_period(500ns).has_value());
  EXPECT_EQ(interpolation_period(1s)->units, 100);
  EXPECT_EQ(interpolation_period(1s)->exponent, -2);
  EXPECT_EQ(interpolation_period(Duration::max()), std::nullopt);
}

// What a header that is flashed asserts.
constexpr DriveConfig<float> drive{.node_id = 1, .force_per_torque_N_per_Nm = 50};
constexpr NetworkConfig usual_network{.period = 1ms};
constexpr AxisScale<float> usual_scale{.encoder_resolution_m = 1e-6F, .max_force_N = 50};
static_assert(check(drive, usual_network, usual_scale) == DriveConfigError::none);
static_assert(check(drive, {}, usual_scale) == DriveConfigError::period, "a period is never implied");
static_assert(check(DriveConfig<double>{.force_per_torque_N_per_Nm = 50}, usual_network, AxisScale<double>{1e-6, 50}) ==
              DriveConfigError::none);

template <class Scalar>
class DriveConfigTest : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(DriveConfigTest, Scalars);

template <class Scalar>
struct Given {
  DriveConfig<Scalar> drive{.force_per_torque_N_per_Nm = 50};
  NetworkConfig network{.period = 1ms};
  AxisScale<Scalar> scale{Scalar(1e-6), 50};
};

TYPED_TEST(DriveConfigTest, NamesTheFieldThatIsOutOfRange) {
  using G = Given<TypeParam>;
  using Limits = std::numeric_limits<TypeParam>;
  const auto error_after = [](auto change) {
    G given;
    change(given);
    return check(given.drive, given.network, given.scale);
  };
  EXPECT_EQ(error_after([](G&) {}), DriveConfigError::none);
  EXPECT_EQ(error_after([](G& g) { g.drive.node_id = 0; }), DriveConfigError::node_id);
  EXPECT_EQ(error_after([](G& g) { g.drive.node_id = 128; }), DriveConfigError::node_id);
  EXPECT_EQ(error_after([](G& g) { g.network.node_id = g.drive.node_id; }), DriveConfigError::master_node_id);
  EXPECT_EQ(error_after([](G& g) { g.network.node_id = 0; }), DriveConfigError::master_node_id);
  EXPECT_EQ(error_after([](G& g) { g.network.node_id = 128; }), DriveConfigError::master_node_id);
  EXPECT_EQ(error_after([](G& g) { g.drive.heartbeat_period = 0ms; }), DriveConfigError::heartbeat_period);
  EXPECT_EQ(error_after([](G& g) { g.drive.heartbeat_period = 65'536ms; }), DriveConfigError::heartbeat_period);
  EXPECT_EQ(error_after([](G& g) { g.drive.heartbeat_timeout = g.drive.heartbeat_period; }),
            DriveConfigError::heartbeat_timeout);
  EXPECT_EQ(error_after([](G& g) { g.drive.heartbeat_timeout = 65'536ms; }), DriveConfigError::heartbeat_timeout);
  EXPECT_EQ(error_after([](G& g) { g.network.heartbeat_period = g.drive.heartbeat_timeout; }),
            DriveConfigError::heartbeat_timeout)
      << "the drive would miss every heartbeat of its master";
  EXPECT_EQ(error_after([](G& g) { g.network.heartbeat_period = 2 * g.network.period - 1us; }),
            DriveConfigError::master_heartbeat_period)
      << "it would take the place of every other acyclic frame, or of all";
  EXPECT_EQ(error_after([](G& g) { g.network.heartbeat_period = 2 * g.network.period; }), DriveConfigError::none);
  EXPECT_EQ(error_after([](G& g) { g.network.heartbeat_period = 0ms; }), DriveConfigError::none)
      << "a master without heartbeats is not supervised";
  EXPECT_EQ(error_after([](G& g) { g.drive.sdo_timeout = 0ms; }), DriveConfigError::sdo_timeout);
  EXPECT_EQ(error_after([](G& g) { g.drive.sdo_timeout = -1ms; }), DriveConfigError::sdo_timeout);
  EXPECT_EQ(error_after([](G& g) { g.drive.homing.timeout = 0ms; }), DriveConfigError::homing_timeout);
  EXPECT_EQ(error_after([](G& g) { g.drive.emcy_information.last[3] = 0x00FF; }), DriveConfigError::emcy_information);
  EXPECT_EQ(error_after([](G& g) { g.drive.emcy_information.first[0] = g.drive.emcy_information.last[0] = 0x0100; }),
            DriveConfigError::none);
  EXPECT_EQ(error_after([](G& g) { g.network.period = 1111us; }), DriveConfigError::period);
  EXPECT_EQ(error_after([](G& g) { g.network.period = 0ms; }), DriveConfigError::period);
  for (const TypeParam wrong : {TypeParam{0}, TypeParam{-1}, Limits::infinity(), Limits::quiet_NaN()}) {
    EXPECT_EQ(error_after([=](G& g) { g.scale.encoder_resolution_m = wrong; }), DriveConfigError::encoder_resolution);
    EXPECT_EQ(error_after([=](G& g) { g.drive.force_per_torque_N_per_Nm = wrong; }),
              DriveConfigError::force_per_torque);
    EXPECT_EQ(error_after([=](G& g) { g.scale.max_force_N = wrong; }), DriveConfigError::max_force);
  }
}

TYPED_TEST(DriveConfigTest, TakesTheEndsOfEveryRange) {
  Given<TypeParam> given;
  given.drive.node_id = 127;
  given.network.node_id = 126;
  given.drive.heartbeat_period = 1ms;
  given.drive.heartbeat_timeout = 65'535ms;
  given.scale.max_force_N = given.scale.encoder_resolution_m = given.drive.force_per_torque_N_per_Nm =
      std::numeric_limits<TypeParam>::max();
  EXPECT_EQ(check(given.drive, given.network, given.scale), DriveConfigError::none);
}

TYPED_TEST(DriveConfigTest, NamesTheFirstOfSeveral) {
  const DriveConfig<TypeParam> nothing{.node_id = 0};
  EXPECT_EQ(check(nothing, {}, AxisScale<TypeParam>{}), DriveConfigError::node_id);
}

}  // namespace
