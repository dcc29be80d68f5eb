// The controller node over slcan in this process: what the emulated targets are held to must itself be right.
#include "closed_loop.hpp"

#include <gtest/gtest.h>

namespace breakaway::emulated {
namespace {

class SlcanClosedLoopTest : public testing::Test {
 protected:
  const scenario::Scenario scenario_ = bench::axis_scenario();
  const law::K3Table<float> table_ = bench::build_table<float>(scenario_).table;
  SlcanWorld world_{scenario_};
  Commander commander_{scenario_};
};

TEST_F(SlcanClosedLoopTest, ReachesEveryCommandedTargetAndRests) {
  run_node_here(scenario_, table_, world_, commander_);
  EXPECT_TRUE(world_.sticking());
  EXPECT_NEAR(world_.position_m(), commander_.target_m(), scenario_.run->settle_tolerance_m);
  EXPECT_GT(commander_.target_m(), 0.11);
}

TEST_F(SlcanClosedLoopTest, IsTheSameInEveryRun) {
  run_node_here(scenario_, table_, world_, commander_);
  SlcanWorld again{scenario_};
  Commander commander{scenario_};
  run_node_here(scenario_, table_, again, commander);
  EXPECT_EQ(again.frame_hash(), world_.frame_hash());
  EXPECT_EQ(again.positions_m(), world_.positions_m());
}

}  // namespace
}  // namespace breakaway::emulated
