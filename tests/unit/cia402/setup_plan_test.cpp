#include "breakaway/cia402/setup_plan.hpp"

#include <gtest/gtest.h>

#include "breakaway/cia402/objects.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::cia402;

TEST(SetupPlan, ReadsBeforeItWritesAndEndsWithTheMode) {
  const SetupPlan plan{DriveConfig<float>{.node_id = 3}, {.period = 1ms}};
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

}  // namespace
