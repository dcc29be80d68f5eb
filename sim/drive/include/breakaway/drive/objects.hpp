// The objects of the emulated drive beside its PDOs: identity and communication (CiA 301), drive profile (CiA 402).
#pragma once

#include "breakaway/drive/config.hpp"
#include "breakaway/drive/object_dictionary.hpp"

namespace breakaway::drive {

void add_communication_objects(ObjectDictionary& dictionary, const DriveConfig& config);
void add_drive_objects(ObjectDictionary& dictionary, const DriveConfig& config);

}  // namespace breakaway::drive
