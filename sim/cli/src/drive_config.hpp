// What `breakaway drive` plays: a drive of the scenario, changed as the command's options say.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/odrive_emulator/odrive_emulator.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::cli {

struct DriveChanges {
  std::optional<unsigned> node_id;     // nothing: the scenario's
  std::optional<double> mode_delay_s;  // nothing: the scenario's
  std::string supported_modes;         // hexadecimal; empty: the emulator's
};

using DriveConfig = std::variant<drive_emulator::EmulatorConfig, odrive_emulator::EmulatorConfig>;

// `world` must have a drive. Throws InputError: a change is none of a drive of its protocol.
DriveConfig drive_config(const scenario::AxisWorld& world, const DriveChanges& changes);

}  // namespace breakaway::cli
