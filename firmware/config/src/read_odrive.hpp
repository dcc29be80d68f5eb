// The [drive] of an axis whose drive speaks CANSimple.
#pragma once

#include <cstddef>
#include <optional>

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// The keys that only a drive of this protocol has, and those that it has not; in the other they are refused by name.
std::vector<Key> odrive_keys_refused();

// `place`: of the axis in its node.
Drive read_odrive(const Section& section, std::size_t place, const Node& node);

// A float of turns must be as fine as a count everywhere between the limits. What it is off beside half a count is
// added to the noise of a reading.
void take_in_spacing(const Section& drive, const std::optional<Section>& limits, Axis& axis);

}  // namespace breakaway::config
