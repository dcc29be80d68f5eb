#include "drive_config.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>

#include "breakaway/input/input_error.hpp"
#include "breakaway/odrive/messages.hpp"

namespace breakaway::cli {
namespace {

// What is of CANopen is not of every drive.
odrive_emulator::EmulatorConfig odrive_config(const scenario::AxisWorld& world, const DriveChanges& changes) {
  const auto refuse = [](const char* option) {
    throw InputError{fmt::format("{} is of a CANopen drive, and [drive] protocol is \"odrive\"; leave it out", option)};
  };
  if (!changes.supported_modes.empty()) refuse("--supported-modes");
  if (changes.mode_delay_s) refuse("--mode-delay");
  odrive_emulator::EmulatorConfig config = *world.odrive;
  const unsigned node_id = changes.node_id.value_or(config.node_id);
  if (node_id > odrive::most_node_id)
    throw InputError{fmt::format("--node-id {}: an ODrive has one of 0 to {}", node_id, odrive::most_node_id)};
  config.node_id = static_cast<std::uint8_t>(node_id);
  return config;
}

}  // namespace

DriveConfig drive_config(const scenario::AxisWorld& world, const DriveChanges& changes) {
  if (world.odrive) return odrive_config(world, changes);
  drive_emulator::EmulatorConfig config = *world.drive;
  if (changes.node_id == 0u) throw InputError{"--node-id 0: a CANopen drive has one of 1 to 127"};
  if (changes.node_id) config.node_id = static_cast<std::uint8_t>(*changes.node_id);
  if (!changes.supported_modes.empty())
    config.supported_modes = static_cast<std::uint32_t>(std::stoul(changes.supported_modes, nullptr, 16));
  if (changes.mode_delay_s) config.quirks.mode_display_delay = hal::Duration{std::llround(*changes.mode_delay_s * 1e9)};
  return config;
}

}  // namespace breakaway::cli
