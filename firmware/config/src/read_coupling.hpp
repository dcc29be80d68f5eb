// [coupling]: what a node is told of how its axes push each other.
#pragma once

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// The axes of the node were read before.
Coupling read_coupling(const Section& section, const Node& node);

}  // namespace breakaway::config
