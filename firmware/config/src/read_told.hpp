// [told]: what the node is told of an axis where that is not the truth.
#pragma once

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// Keeps the truth in axis.truth and puts what is told in its place. The plant, the friction and the drive of the axis
// must have been read. Throws InputError.
void read_told(const Section& section, Axis& axis);

}  // namespace breakaway::config
