#include "breakaway/cia402/setup_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <span>

#include "breakaway/cia402/objects.hpp"

namespace {

using namespace std::chrono_literals;
using namespace breakaway::cia402;

using Kind = SetupStep::Kind;

std::size_t place_of(std::span<const SetupStep> steps, Kind kind, std::uint16_t index) {
  return static_cast<std::size_t>(
      std::ranges::find_if(steps, [&](const SetupStep& step) { return step.kind == kind && step.index == index; }) -
      steps.begin());
}

TEST(SetupPlan, SwitchesTheDriveOffBeforeAnythingElseAndLooksAtItAfterwards) {
  const SetupPlan plan{DriveConfig<float>{.node_id = 3}, {.period = 1ms}};
  const auto steps = plan.steps();
  EXPECT_EQ(steps[0].index, object::controlword);
  EXPECT_EQ(steps[1].index, object::target_torque);
  EXPECT_EQ(steps[2].index, object::statusword);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(steps[i].kind, Kind::write);
    EXPECT_EQ(steps[i].value, 0U);
    EXPECT_EQ(steps[i].size, 2U);
  }
  std::size_t unseen = 0;
  for (const SetupStep& step : steps) {
    unseen = step.kind == Kind::read && step.index == object::statusword ? 0 : unseen + 1;
    EXPECT_LE(unseen, 20U) << "steps in which nobody would see that it is switched on again";
  }
}

TEST(SetupPlan, ReadsBackWhatBoundsTheForceBeforeThePdosPass) {
  const SetupPlan plan{DriveConfig<float>{.node_id = 3}, {.period = 1ms}};
  const auto steps = plan.steps();
  const std::size_t pdos = place_of(steps, Kind::write, object::rpdo1_parameter);
  ASSERT_LT(pdos, steps.size());
  for (const std::uint16_t index : {object::torque_offset, object::sync_cob_id, object::quick_stop_option,
                                    object::shutdown_option, object::disable_option, object::fault_reaction_option}) {
    const std::size_t written = place_of(steps, Kind::write, index);
    ASSERT_LT(written, pdos) << index;
    EXPECT_EQ(steps[written].value, index == object::sync_cob_id ? 0x80U : 0U);
    EXPECT_TRUE(steps[written].optional);
    EXPECT_EQ(steps[written + 1].index, index);
    EXPECT_TRUE(steps[written + 1].kind == Kind::check || steps[written + 1].kind == Kind::confirm);
  }
  EXPECT_LT(place_of(steps, Kind::read, object::max_torque), place_of(steps, Kind::write, object::max_torque));
}

TEST(SetupPlan, TellsTheDriveItsTimesAndEndsWithTheMode) {
  const SetupPlan plan{DriveConfig<float>{.node_id = 3}, {.period = 1ms}};
  const auto steps = plan.steps();
  EXPECT_EQ(steps.back().index, object::mode);
  EXPECT_EQ(steps.back().value, 10U);
  for (const SetupStep& step : steps) {
    if (step.index == object::consumer_heartbeat) {
      EXPECT_EQ(step.value, 0x007F00FAU);
    }
    if (step.index == object::rpdo1_parameter && step.subindex == 5) {
      EXPECT_EQ(step.value, 4U) << "the command after two that were lost is not yet late";
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
