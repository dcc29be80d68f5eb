// The objects of the emulated drive beside its PDOs: identity and communication (CiA 301), and the drive profile (CiA
// 402).
#pragma once

#include <cstdint>

#include "breakaway/drive_emulator/config.hpp"
#include "breakaway/drive_emulator/object_dictionary.hpp"

namespace breakaway::drive_emulator {

// Indices of objects that the project's client has no use for; the others are in cia402::object.
namespace own_object {
inline constexpr std::uint16_t error_history = 0x1003;           // :00 u8 number of errors, :01.. u32 error codes
inline constexpr std::uint16_t device_name = 0x1008;             // text
inline constexpr std::uint16_t error_behaviour = 0x1029;         // :01 u8, see EmulatorConfig
inline constexpr std::uint16_t sdo_server_parameter = 0x1200;    // :01 u32 COB-ID of requests, :02 u32 of responses
inline constexpr std::uint16_t motor_catalogue_number = 0x6403;  // text
}  // namespace own_object

void add_communication_objects(ObjectDictionary& dictionary, const EmulatorConfig& config);
void add_drive_objects(ObjectDictionary& dictionary, const EmulatorConfig& config);

}  // namespace breakaway::drive_emulator
