#include "breakaway/cia402/setup_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "breakaway/cia402/objects.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::cia402;
using breakaway::hal::Duration;
using breakaway::hal::StatusCode;

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

TEST(SetupPlan, ReadsBeforeItWritesAndEndsWithTheMode) {
  const SetupPlan plan{{.node_id = 3}};
  const auto steps = plan.steps();
  ASSERT_EQ(steps.size(), 28U);
  EXPECT_EQ(steps.front().index, object::device_type);
  EXPECT_EQ(steps.back().index, object::mode);
  EXPECT_EQ(steps.back().value, 10U);
  bool written = false;
  for (const SetupStep& step : steps) {
    written = written || step.kind == SetupStep::Kind::write;
    EXPECT_EQ(step.kind == SetupStep::Kind::write, written);
    if (step.index == object::consumer_heartbeat) {
      EXPECT_EQ(step.value, 0x007F00FAU);
    }
    if (step.index == object::rpdo1_parameter && step.subindex == 5) {
      EXPECT_EQ(step.value, 3U) << "two lost commands in a row are tolerated";
      EXPECT_TRUE(step.optional);
    }
    if (step.index == object::sync_period) {
      EXPECT_EQ(step.value, 1000U);
    }
    if (step.index == object::interpolation_period && step.subindex == 2) {
      EXPECT_EQ(step.value, 0xFDU);
    }
  }
}

TEST(NodeConfig, NamesTheFieldThatIsOutOfRange) {
  const NodeConfig good{};
  EXPECT_TRUE(check(good).ok());
  const auto expect = [&](std::uint32_t detail, auto change) {
    NodeConfig config = good;
    change(config);
    EXPECT_EQ(check(config).code, StatusCode::invalid_argument);
    EXPECT_EQ(check(config).detail, detail);
  };
  expect(1, [](NodeConfig& c) { c.node_id = 0; });
  expect(1, [](NodeConfig& c) { c.node_id = 128; });
  expect(2, [](NodeConfig& c) { c.master_node_id = c.node_id; });
  expect(3, [](NodeConfig& c) { c.heartbeat_period = 0ms; });
  expect(4, [](NodeConfig& c) { c.heartbeat_timeout = c.heartbeat_period; });
  expect(5, [](NodeConfig& c) { c.sdo_timeout = -1ms; });
  expect(6, [](NodeConfig& c) { c.period = 1111us; });
}

}  // namespace
