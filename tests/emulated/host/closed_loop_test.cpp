// The controller node over slcan in this process: what the emulated targets are held to must itself be right.
#include "closed_loop.hpp"

#include <gtest/gtest.h>

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
  EXPECT_NEAR(world_.position_m(), commander_.target_m(), scenario_.run->settle_tolerance_m);
  EXPECT_GT(commander_.target_m(), 0.11);
}

// The configuration in firmware/targets/can_axis repeats what the scenario says of drive and limits.
TEST_F(SlcanClosedLoopTest, RunsTheNodeOfItsScenario) {
  const auto drive = bench::drive_config<float>(scenario_, scenario_.drive->node_id);
  const auto scale = bench::axis_scale<float>(scenario_);
  const auto limits = bench::limits<float>(scenario_);
  const auto& node = flashed::node;
  EXPECT_EQ(node.loop.period, bench::period_of(scenario_));
  EXPECT_EQ(node.loop.bit_rate, scenario_.bus->bit_rate);
  EXPECT_EQ(node.drive.node_id, drive.node_id);
  EXPECT_EQ(node.axis->parameters.encoder_resolution_m, scale.encoder_resolution_m);
  EXPECT_EQ(node.drive.force_per_torque_N_per_Nm, drive.force_per_torque_N_per_Nm);
  EXPECT_EQ(node.axis->parameters.max_force_N, scale.max_force_N);
  EXPECT_EQ(node.limits.position_min_m, limits.position_min_m);
  EXPECT_EQ(node.limits.position_max_m, limits.position_max_m);
  EXPECT_EQ(node.limits.speed_m_s, limits.speed_m_s);
  EXPECT_EQ(node.axis->parameters.kick_damping_Ns_per_m,
            scenario::axis_parameters<float>(scenario_).kick_damping_Ns_per_m);
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
