// FaultScope says what else stops when one axis of a node has a fault.
#pragma once

#include <cstdint>

namespace breakaway::firmware {

enum class FaultScope : std::uint8_t {
  axis,      // nothing: the other axes go on
  all_axes,  // every axis of the node, each with the fault "stopped with another axis"
};

}  // namespace breakaway::firmware
