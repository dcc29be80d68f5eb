// Network management (CiA 301, 7.2.8): the master's commands and the states that nodes report.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/hal/can_frame.hpp"

namespace breakaway::canopen {

// The values are those of a heartbeat's byte.
enum class NmtState : std::uint8_t { boot_up = 0x00, stopped = 0x04, operational = 0x05, pre_operational = 0x7F };

// The values are those of an NMT frame's first byte.
enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  enter_pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};

inline constexpr std::uint8_t all_nodes = 0;

// node_id: 1..127, or all_nodes.
constexpr hal::CanFrame nmt_frame(NmtCommand command, std::uint8_t node_id) noexcept {
  return {.id = nmt_cob_id, .size = 2, .remote = false, .data = {static_cast<std::uint8_t>(command), node_id}};
}

constexpr bool is_nmt_state(std::uint8_t value) noexcept {
  return value == 0x00 || value == 0x04 || value == 0x05 || value == 0x7F;
}

constexpr std::string_view to_string(NmtState state) noexcept {
  switch (state) {
    case NmtState::boot_up:
      return "boot-up";
    case NmtState::stopped:
      return "stopped";
    case NmtState::operational:
      return "operational";
    case NmtState::pre_operational:
      return "pre-operational";
  }
  return "unknown NMT state";
}

}  // namespace breakaway::canopen
