// A data sheet played: the emulated drive has what the sheet has, and refuses what it has not.
#pragma once

#include "breakaway/config/node.hpp"
#include "breakaway/drive_emulator/config.hpp"

namespace breakaway::scenario {

// For an axis whose drive has a data sheet, in a node with a [loop]. What the file says of the drive's quirks stays.
void play_sheet(const config::Node& node, const config::Axis& axis, drive_emulator::EmulatorConfig& drive);

}  // namespace breakaway::scenario
