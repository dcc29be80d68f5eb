// What the set-up of a drive asks of it, held against its data sheet before the drive is connected.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/config/data_sheet.hpp"
#include "breakaway/config/node.hpp"

namespace breakaway::config {

// The first thing that keeps this drive from being run, in a sentence with its remedy; nothing where there is none.
// Requires a [loop] and an axis whose drive has a data sheet.
std::optional<std::string> what_is_lacking(const Node& node, const Axis& axis);

// Objects that the set-up asks for, goes on without, and that the sheet does not have.
std::vector<std::uint16_t> objects_done_without(const Node& node, const Axis& axis);

// Whether the sheet's first RPDO and TPDO cannot be mapped anew.
bool has_fixed_mapping(const DataSheet& sheet);

}  // namespace breakaway::config
