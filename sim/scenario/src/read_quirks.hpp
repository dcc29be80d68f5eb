// What [drive.quirks] says of how the emulated drive departs from what set-up expects of one.
#pragma once

#include "breakaway/config/toml_section.hpp"
#include "breakaway/drive_emulator/config.hpp"

namespace breakaway::scenario {

void read_quirks(const config::Section& section, drive_emulator::Quirks& q);

}  // namespace breakaway::scenario
