// What an image carries in place of the scenario's file must be that scenario, and its run must be right.
#include "world_run.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "breakaway/config/axis_design.hpp"
#include "breakaway/config/flash.hpp"
#include "breakaway/scenario/read_scenario.hpp"
#include "controller_report.hpp"

namespace breakaway::emulated {
namespace {

scenario::Scenario two_axes() { return scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_axes.toml"); }

TEST(WorldRun, ReachesTheLastTargetsOfBothAxesAndRests) {
  const WorldRun run{ticks_to_run};
  EXPECT_TRUE(run.world().settled()) << run.world().error_m(0) << ' ' << run.world().error_m(1);
  const auto& positions_m = run.world().positions_m();
  EXPECT_GT(positions_m[positions_m.size() - 2], 0.11);
  EXPECT_LT(positions_m.back(), -0.11);
}

// The last that the node said of an axis; nothing: it said nothing.
std::optional<LoggedFrame> last_status(const NodeWorld& world, std::uint8_t axis) {
  std::optional<LoggedFrame> last;
  for (const LoggedFrame& frame : world.frames()) {
    if (frame.id == canopen::tpdo_cob_id(1, flashed::node.loop.network.node_id) && frame.data[0] == axis) last = frame;
  }
  return last;
}

TEST(WorldRun, TakesTheCommandsOfEachAxisAndTellsOfEachWhereItIs) {
  const WorldRun run{ticks_to_run};
  for (std::uint8_t axis = 0; axis < world_axes.size(); ++axis) {
    const auto told = last_status(run.world(), axis);
    ASSERT_TRUE(told.has_value()) << axis;
    EXPECT_EQ(told->data[1], static_cast<std::uint8_t>(firmware::AxisFault::none));
    EXPECT_EQ(told->data[2], static_cast<std::uint8_t>(law::Mode::hold));
    EXPECT_EQ(told->data[3], static_cast<std::uint8_t>(hal::DriveState::enabled));
    const auto counts = canopen::load_little_endian<std::int32_t>(told->data, 4);
    EXPECT_NEAR(counts, axis == 0 ? 110'520 : -110'520, 3) << "in the axis' direction, whatever the drive's";
  }
}

TEST(WorldRun, IsTheSameEveryTime) {
  const WorldRun once{2000}, again{2000};
  EXPECT_EQ(once.world().frames(), again.world().frames());
  EXPECT_EQ(once.world().positions_m(), again.world().positions_m());
}

TEST(WorldRun, IsOfTheNodeOfTheScenario) {
  const config::Node node = two_axes().node;
  EXPECT_EQ(flashed::node.checksum, config::certified(node, config::examine(node)).checksum);
}

class WorldAxes : public testing::TestWithParam<std::size_t> {
 protected:
  const scenario::Scenario scenario_ = two_axes();
  const config::Axis& axis_ = scenario_.node.axes[GetParam()];
  const scenario::AxisWorld& world_ = scenario_.worlds[GetParam()];
};

TEST_P(WorldAxes, AreThoseOfTheScenario) {
  const WorldAxis& here = world_axes[GetParam()];
  EXPECT_EQ(here.mass_kg, axis_.mass_kg);
  EXPECT_EQ(here.start_m, world_.position_m);
  EXPECT_EQ(settle_tolerance_m, scenario_.node.settle_tolerance_m);
  EXPECT_EQ(here.friction.lower_N, axis_.friction.bounds.lower_N);
  EXPECT_EQ(here.friction.upper_N, axis_.friction.bounds.upper_N);
  EXPECT_EQ(here.mounting == sil::Mounting::inverted, axis_.drive->invert_direction);
  const model::AppliedForce push{.constant_N = 16, .stiffness_N_per_m = 2, .damping_Ns_per_m = 1};
  motion::Slide slide = resting_axis(GetParam());
  motion::Slide there{axis_.mass_kg, world_.friction, {0, world_.position_m, 0}};
  slide.advance_to(3, push);
  there.advance_to(3, push);
  EXPECT_NE(slide.state().position_m, here.start_m);
  EXPECT_EQ(slide.state().position_m, there.state().position_m) << "one friction law";
}

TEST_P(WorldAxes, HaveTheDrivesOfTheScenario) {
  const drive_emulator::EmulatorConfig here = drive_config(GetParam());
  const drive_emulator::EmulatorConfig& there = *world_.drive;
  EXPECT_EQ(here.node_id, there.node_id);
  EXPECT_EQ(here.rated_torque_mNm, there.rated_torque_mNm);
  EXPECT_EQ(here.rated_current_mA, there.rated_current_mA);
  EXPECT_EQ(here.max_torque_per_mille, there.max_torque_per_mille);
  EXPECT_EQ(here.force_per_torque_N_per_Nm, there.force_per_torque_N_per_Nm);
  EXPECT_EQ(here.encoder_resolution_m, there.encoder_resolution_m);
  EXPECT_EQ(here.current_loop_time_constant_s, there.current_loop_time_constant_s);
  EXPECT_EQ(here.peak_force_N, there.peak_force_N);
  EXPECT_EQ(here.min_tpdo_delay, there.min_tpdo_delay);
  EXPECT_EQ(here.max_tpdo_delay, there.max_tpdo_delay);
}

INSTANTIATE_TEST_SUITE_P(Both, WorldAxes, testing::Values(0U, 1U));

}  // namespace
}  // namespace breakaway::emulated
