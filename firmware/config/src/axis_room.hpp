// What the [limits] of an axis must leave room for.
#pragma once

#include <string>

#include "breakaway/config/node.hpp"
#include "breakaway/design/report.hpp"

namespace breakaway::config {

// For the beginning of a sentence. Where there is one axis only, naming the file is enough.
std::string at_axis(const Node& node, const Axis& axis);

// What the drive is to carry acts alone from when the brake opens until the drive gives the feedforward, which begins
// with the answer to the first sample and rises with the current loop. Meanwhile friction alone holds against it.
struct Sag {
  double way_m = 0, speed_m_s = 0;
};
// At most; nothing where friction holds the axis, or no force is fed forward.
Sag sag_of(const Node& node, const Axis& axis);

// Throws InputError where a certified axis could run into a limit that it is stopped for.
void require_room(const Node& node, const Axis& axis, const design::DesignReport& report);

}  // namespace breakaway::config
