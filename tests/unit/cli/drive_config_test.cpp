#include "../../../sim/cli/src/drive_config.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <variant>

#include "breakaway/input/input_error.hpp"
#include "breakaway/scenario/read_scenario.hpp"

namespace breakaway::cli {
namespace {

using namespace std::chrono_literals;

scenario::AxisWorld world_with(const std::string& quirks) {
  std::string text =
      "[plant]\nmass_kg = 1\n[friction]\nlower_N = 2.5\nupper_N = 4.5\n[controller]\nk1_N_per_m = 400\n"
      "k21_Ns_per_m = 32\nk22_Ns_per_m = 60\n[loop]\nperiod_s = 0.001\n[drive]\nnode_id = 5\n"
      "rated_torque_Nm = 1\nmax_torque_per_mille = 1000\nforce_per_torque_N_per_Nm = 50\n"
      "encoder_resolution_m = 1e-6\n[bus]\n[run]\nduration_s = 1\nsettle_tolerance_m = 1e-5\n";
  return scenario::parse_scenario(text + quirks, "axis.toml").worlds.front();
}

const drive_emulator::EmulatorConfig& canopen(const DriveConfig& config) {
  return std::get<drive_emulator::EmulatorConfig>(config);
}

TEST(DriveConfig, IsTheScenariosWithoutAnyChange) {
  const scenario::AxisWorld world = world_with("[drive.quirks]\nmode_display_delay_s = 0.75\n");
  const DriveConfig config = drive_config(world, {});
  EXPECT_EQ(canopen(config).quirks.mode_display_delay, 750ms);
  EXPECT_EQ(canopen(config).node_id, 5);
  EXPECT_EQ(canopen(config).supported_modes, world.drive->supported_modes);
}

TEST(DriveConfig, HasWhatTheOptionsSayInPlaceOfTheScenarios) {
  const DriveConfig config = drive_config(world_with("[drive.quirks]\nmode_display_delay_s = 0.75\n"),
                                          {.node_id = 9, .mode_delay_s = 0.25, .supported_modes = "1FF"});
  EXPECT_EQ(canopen(config).quirks.mode_display_delay, 250ms);
  EXPECT_EQ(canopen(config).node_id, 9);
  EXPECT_EQ(canopen(config).supported_modes, 0x1FFU);
}

TEST(DriveConfig, OfAnOdriveMayHaveTheNodeIdZeroAndOfCanopenNot) {
  const scenario::Scenario s = scenario::read_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/odrive_axis.toml");
  DriveChanges changes;
  changes.node_id = 0;
  const DriveConfig config = drive_config(s.worlds.front(), changes);
  EXPECT_EQ(std::get<odrive_emulator::EmulatorConfig>(config).node_id, 0);
  EXPECT_THROW(static_cast<void>(drive_config(world_with(""), changes)), InputError);
}

}  // namespace
}  // namespace breakaway::cli
