// The [drive] of an axis.
#pragma once

#include <cstddef>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// `place`: of the axis in its node. others: rows of what a simulation reads there.
Drive read_drive(const Section& section, std::size_t place, const Node& node, std::vector<Key> others);

// What is said of a drive whatever protocol it speaks.
std::vector<Key> rows_of_any_drive(Drive& d);

// A drive has an id of its own, and expects no more of heartbeats than the node gives.
void check_in_node(const Section& section, const Drive& drive, const Node& node);

}  // namespace breakaway::config
