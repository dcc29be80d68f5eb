// The controller node over slcan in this process: what the emulated targets are held to must itself be right.
#include "closed_loop.hpp"

#include <gtest/gtest.h>

#include "breakaway/config/axis_design.hpp"

namespace breakaway::emulated {
namespace {

class SlcanClosedLoopTest : public testing::Test {
 protected:
  const scenario::Scenario scenario_ = bench::axis_scenario();
  SlcanWorld world_{scenario_};
  Commander commander_{scenario_};
};

TEST_F(SlcanClosedLoopTest, ReachesEveryCommandedTargetAndRests) {
  run_node_here(world_, commander_);
  EXPECT_TRUE(world_.sticking());
  EXPECT_NEAR(world_.position_m(), commander_.target_m(), scenario_.node.settle_tolerance_m);
  EXPECT_GT(commander_.target_m(), 0.11);
}

TEST_F(SlcanClosedLoopTest, RunsTheNodeOfItsScenario) {
  EXPECT_EQ(flashed::node.checksum, config::certified(scenario_.node, config::examine(scenario_.node)).checksum);
}

TEST_F(SlcanClosedLoopTest, IsTheSameInEveryRun) {
  run_node_here(world_, commander_);
  SlcanWorld again{scenario_};
  Commander commander{scenario_};
  run_node_here(again, commander);
  EXPECT_EQ(again.frame_hash(), world_.frame_hash());
  EXPECT_EQ(again.positions_m(), world_.positions_m());
}

}  // namespace
}  // namespace breakaway::emulated
