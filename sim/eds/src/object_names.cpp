#include "object_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

namespace breakaway::eds {
namespace {

// Indices from `first` to `last` are one kind of object; a # in a name stands for the place among them, from 1.
struct Row {
  std::uint16_t first, last;
  Kind kind;
  std::string_view name;
  // Sub-indices from 1, parted by '|'. A # in the last stands for its own number, and it is then for all that follow.
  std::string_view entries;
};

using enum Kind;

constexpr std::string_view pdo_parameter = "COB-ID|Transmission type|Inhibit time|Reserved|Event timer";
constexpr std::string_view axis_entries =
    "Name|Target|Position|Position in m|Commanded force|Reported force|Mode|Drive state|Fault|Fault name|Fault "
    "code|Stop not obeyed|Statusword of the drive|Set-up status|Object of the set-up|Newest emergency";

constexpr Row rows[] = {
    {0x1000, 0x1000, variable, "Device type", ""},
    {0x1001, 0x1001, variable, "Error register", ""},
    {0x1003, 0x1003, array, "Pre-defined error field", "Standard error field #"},
    {0x1005, 0x1005, variable, "COB-ID SYNC", ""},
    {0x1006, 0x1006, variable, "Communication cycle period", ""},
    {0x1007, 0x1007, variable, "Synchronous window length", ""},
    {0x1008, 0x1008, variable, "Manufacturer device name", ""},
    {0x1014, 0x1014, variable, "COB-ID EMCY", ""},
    {0x1016, 0x1016, array, "Consumer heartbeat time", "Consumer heartbeat time #"},
    {0x1017, 0x1017, variable, "Producer heartbeat time", ""},
    {0x1018, 0x1018, record, "Identity object", "Vendor-ID|Product code|Revision number|Serial number"},
    {0x1029, 0x1029, array, "Error behaviour", "Communication error"},
    {0x1200, 0x1200, record, "SDO server parameter", "COB-ID client to server|COB-ID server to client"},
    {0x1400, 0x15FF, record, "RPDO # communication parameter", pdo_parameter},
    {0x1600, 0x17FF, record, "RPDO # mapping parameter", "Mapped object #"},
    {0x1800, 0x19FF, record, "TPDO # communication parameter", pdo_parameter},
    {0x1A00, 0x1BFF, record, "TPDO # mapping parameter", "Mapped object #"},
    {0x2000, 0x2000, record, "Node",
     "Axes|Period|Steps|Missed ticks|Shortest interval|Longest interval|Frames refused"},
    {0x2101, 0x2108, record, "Axis #", axis_entries},
    {0x603F, 0x603F, variable, "Error code", ""},
    {0x6040, 0x6040, variable, "Controlword", ""},
    {0x6041, 0x6041, variable, "Statusword", ""},
    {0x605A, 0x605A, variable, "Quick stop option code", ""},
    {0x605B, 0x605B, variable, "Shutdown option code", ""},
    {0x605C, 0x605C, variable, "Disable operation option code", ""},
    {0x605D, 0x605D, variable, "Halt option code", ""},
    {0x605E, 0x605E, variable, "Fault reaction option code", ""},
    {0x6060, 0x6060, variable, "Modes of operation", ""},
    {0x6061, 0x6061, variable, "Modes of operation display", ""},
    {0x6064, 0x6064, variable, "Position actual value", ""},
    {0x606C, 0x606C, variable, "Velocity actual value", ""},
    {0x6071, 0x6071, variable, "Target torque", ""},
    {0x6072, 0x6072, variable, "Max torque", ""},
    {0x6074, 0x6074, variable, "Torque demand", ""},
    {0x6075, 0x6075, variable, "Motor rated current", ""},
    {0x6076, 0x6076, variable, "Motor rated torque", ""},
    {0x6077, 0x6077, variable, "Torque actual value", ""},
    {0x607B, 0x607B, array, "Position range limit", "Min position range limit|Max position range limit"},
    {0x607C, 0x607C, variable, "Home offset", ""},
    {0x607E, 0x607E, variable, "Polarity", ""},
    {0x608F, 0x608F, array, "Position encoder resolution", "Encoder increments|Motor revolutions"},
    {0x6091, 0x6091, array, "Gear ratio", "Motor revolutions|Shaft revolutions"},
    {0x6092, 0x6092, array, "Feed constant", "Feed|Shaft revolutions"},
    {0x6098, 0x6098, variable, "Homing method", ""},
    {0x6099, 0x6099, array, "Homing speeds", "Speed during search for switch|Speed during search for zero"},
    {0x609A, 0x609A, variable, "Homing acceleration", ""},
    {0x60B2, 0x60B2, variable, "Torque offset", ""},
    {0x60C2, 0x60C2, record, "Interpolation time period", "Interpolation time period value|Interpolation time index"},
    {0x6403, 0x6403, variable, "Motor catalogue number", ""},
    {0x6502, 0x6502, variable, "Supported drive modes", ""},
};

const Row& row_of(std::uint16_t index) {
  const auto* const found =
      std::ranges::find_if(rows, [=](const Row& row) { return row.first <= index && index <= row.last; });
  if (found == std::end(rows))
    throw std::out_of_range{fmt::format("object {:04X}h has no name: give it a row in object_names.cpp", index)};
  return *found;
}

std::string numbered(std::string_view name, unsigned number) {
  std::string text{name};
  if (const auto place = text.find('#'); place != std::string::npos) text.replace(place, 1, std::to_string(number));
  return text;
}

}  // namespace

ObjectName object_name(std::uint16_t index) {
  const Row& row = row_of(index);
  return {numbered(row.name, index - row.first + 1U), row.kind};
}

std::string entry_name(std::uint16_t index, std::uint8_t sub) {
  if (sub == 0) return "Number of entries";
  std::string_view left = row_of(index).entries;
  for (unsigned number = 1;; ++number) {
    const std::string_view name = left.substr(0, left.find('|'));
    if (!name.empty() && (number == sub || name.find('#') != name.npos)) return numbered(name, sub);
    if (name.size() == left.size())
      throw std::out_of_range{fmt::format("{:04X}h:{:02X} has no name: give it one in object_names.cpp", index, sub)};
    left.remove_prefix(name.size() + 1);
  }
}

}  // namespace breakaway::eds
