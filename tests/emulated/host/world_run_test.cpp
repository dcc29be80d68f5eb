// What an image carries in place of the scenario's file must be that scenario, and its run must be right.
#include "world_run.hpp"

#include <gtest/gtest.h>

#include "axis_under_test.hpp"
#include "controller_report.hpp"

namespace breakaway::emulated {
namespace {

TEST(WorldRun, ReachesTheLastTargetAndRests) {
  const WorldRun run{ticks_to_run};
  EXPECT_TRUE(run.world().resting());
  EXPECT_LE(std::abs(run.world().error_m()), settle_tolerance_m);
  EXPECT_GT(run.world().positions_m().back(), 0.11);
}

TEST(WorldRun, IsTheSameEveryTime) {
  const WorldRun once{2000}, again{2000};
  EXPECT_EQ(once.world().frames(), again.world().frames());
  EXPECT_EQ(once.world().positions_m(), again.world().positions_m());
}

TEST(AxisScene, IsThatOfItsScenario) {
  const scenario::Scenario s = bench::axis_scenario();
  EXPECT_EQ(mass_kg, s.plant.mass_kg);
  EXPECT_EQ(start_m, s.plant.position_m);
  EXPECT_EQ(settle_tolerance_m, s.run->settle_tolerance_m);
  EXPECT_EQ(friction_bounds().lower_N, s.friction.lower_N);
  EXPECT_EQ(friction_bounds().upper_N, s.friction.upper_N);
  const model::AppliedForce push{.constant_N = 8, .stiffness_N_per_m = 2, .damping_Ns_per_m = 1};
  motion::Slide here = resting_axis(), there{s.plant.mass_kg, s.friction.law, {0, start_m, 0}};
  here.advance_to(3, push);
  there.advance_to(3, push);
  EXPECT_EQ(here.state().position_m, there.state().position_m) << "one friction law";
}

TEST(AxisScene, HasTheDriveOfItsScenario) {
  const scenario::Scenario s = bench::axis_scenario();
  const drive_emulator::EmulatorConfig here = drive_config();
  EXPECT_EQ(here.node_id, s.drive->node_id);
  EXPECT_EQ(here.rated_torque_mNm, s.drive->rated_torque_mNm);
  EXPECT_EQ(here.rated_current_mA, s.drive->rated_current_mA);
  EXPECT_EQ(here.max_torque_per_mille, s.drive->max_torque_per_mille);
  EXPECT_EQ(here.force_per_torque_N_per_Nm, s.drive->force_per_torque_N_per_Nm);
  EXPECT_EQ(here.encoder_resolution_m, s.drive->encoder_resolution_m);
  EXPECT_EQ(here.current_loop_time_constant_s, s.drive->current_loop_time_constant_s);
  EXPECT_EQ(here.peak_force_N, s.drive->peak_force_N);
  EXPECT_EQ(here.min_tpdo_delay, s.drive->min_tpdo_delay);
  EXPECT_EQ(here.max_tpdo_delay, s.drive->max_tpdo_delay);
}

}  // namespace
}  // namespace breakaway::emulated
