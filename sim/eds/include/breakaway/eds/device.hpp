// Device: what an electronic data sheet (EDS, CiA 306) says of a CANopen device, and the devices of this project.
//
// Neither is written down a second time: the objects are asked of the dictionary that answers on the bus, at power-on.
// What depends on the node id is found by asking it under two of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/drive_emulator/config.hpp"

namespace breakaway::eds {

// Numbers are those of CiA 301, 7.4.7.
enum class DataType : std::uint8_t { i8 = 2, i16 = 3, i32 = 4, u8 = 5, u16 = 6, u32 = 7, r32 = 8, text = 9 };

enum class Access : std::uint8_t { read_only, write_only, read_write };

// One entry: an object without sub-indices, or one of its sub-indices.
struct Object {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  DataType type = DataType::u32;
  Access access = Access::read_only;
  bool mappable_to_rpdo = false;
  bool mappable_to_tpdo = false;
  std::optional<std::int64_t> low{}, high{};  // where they are narrower than the type
  // As the file has it; nothing where the device itself goes on writing it.
  std::optional<std::string> power_on_value{};
};

struct Device {
  std::string name, description;
  std::uint32_t vendor = 0, product = 0, revision = 0;  // 1018h
  unsigned rpdos = 0, tpdos = 0;
  std::vector<unsigned> bit_rates_kHz{};  // of those that an EDS knows
  std::vector<std::string> comments{};
  std::vector<Object> objects{};  // by index and sub-index
};

// The bit rates that an EDS knows, in kbit/s.
inline constexpr std::uint16_t bit_rates_kHz[] = {10, 20, 50, 125, 250, 500, 800, 1000};

// Returns the emulated drive of an axis. Throws InputError (see drive_emulator::validate()).
Device drive_device(const drive_emulator::EmulatorConfig& config);

// Returns the controller that runs the node. Throws InputError as config::require_flashable().
Device node_device(const config::Node& node);

}  // namespace breakaway::eds
