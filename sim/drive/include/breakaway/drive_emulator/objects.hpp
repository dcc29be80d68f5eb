// The objects of the emulated drive beside its PDOs: identity and communication (CiA 301), drive profile (CiA 402).
#pragma once

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/drive_emulator/object_dictionary.hpp"

namespace breakaway::drive_emulator {

void add_communication_objects(ObjectDictionary& dictionary, const EmulatorConfig& config);
void add_drive_objects(ObjectDictionary& dictionary, const EmulatorConfig& config);

}  // namespace breakaway::drive_emulator
