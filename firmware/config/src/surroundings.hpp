// What a file says of the world, as the certificate of a node must know it.
#pragma once

#include <string_view>

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// Looks at the keys of one table of an axis, as [plant] or [drive]; `table` is its name.
void look_at(const Section& section, std::string_view table, Surroundings& to);

// Looks at the tables beside the axes, which must have been read; what is outside goes to every axis.
void look_at_root(const Section& root, Node& node);

}  // namespace breakaway::config
