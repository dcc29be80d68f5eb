// Which frames the CAN controller lets in: those that the node looks at, and as few others as its filters can tell
// apart.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/firmware/flashed_node.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/xilinx_can/port.hpp"

namespace breakaway::zynqmp_r5 {

using Filters = std::array<std::optional<xilinx_can::Filter>, xilinx_can::filters>;

// Passes all that one of the two passes.
constexpr xilinx_can::Filter joined(xilinx_can::Filter a, xilinx_can::Filter b) noexcept {
  const auto mask = static_cast<std::uint16_t>(a.mask & b.mask & ~(a.id ^ b.id));
  return {.mask = mask, .id = static_cast<std::uint16_t>(a.id & mask)};
}

// All that the drives say and are told, whatever the function; all that bears this node's own id: commands, SDO
// requests, and the heartbeat of another master; and another master's SYNC. Where these are more than there are
// filters, those two are joined which then pass the least.
// Node: a FlashedNode or a FlashedMachine.
template <class Node>
constexpr Filters filters_for(const Node& node) noexcept {
  std::array<xilinx_can::Filter, Node::capacity + 2> wanted{};
  std::size_t count = 0;
  wanted[count++] = {.mask = canopen::node_id_mask, .id = node.loop.network.node_id};
  wanted[count++] = {.mask = hal::CanFrame::max_id, .id = canopen::sync_cob_id};
  for (std::size_t i = 0; i < node.count && i < Node::capacity; ++i)
    wanted[count++] = {.mask = canopen::node_id_mask, .id = node.axes[i].drive.node_id};
  while (count > xilinx_can::filters) {
    std::size_t first = 0, second = 1;
    const auto bits = [&](std::size_t i, std::size_t k) { return std::popcount(joined(wanted[i], wanted[k]).mask); };
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = i + 1; k < count; ++k)
        if (bits(i, k) > bits(first, second)) {
          first = i;
          second = k;
        }
    wanted[first] = joined(wanted[first], wanted[second]);
    wanted[second] = wanted[--count];
  }
  Filters filters{};
  for (std::size_t i = 0; i < count; ++i) filters[i] = wanted[i];
  return filters;
}

}  // namespace breakaway::zynqmp_r5
