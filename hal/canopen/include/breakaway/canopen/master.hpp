// Master: what the loop sends and hears on a CANopen bus that concerns no single drive: SYNC, its own heartbeat, and
// whoever else takes itself for the master.
#pragma once

#include <cstdint>

#include "breakaway/canopen/bus_budget.hpp"
#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/canopen/heartbeat.hpp"
#include "breakaway/canopen/nmt.hpp"
#include "breakaway/canopen/sync.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::canopen {

class Master {
 public:
  constexpr explicit Master(const hal::NetworkConfig& network) noexcept
      : own_heartbeat_{heartbeat_cob_id(network.node_id)}, heartbeat_{network.node_id, network.heartbeat_period} {}

  // The node that the frame is from or for.
  static constexpr std::uint8_t node_of(const hal::CanFrame& frame) noexcept { return node_id_of(frame.id); }
  // Only the master sends this. What we send ourselves does not come back.
  constexpr bool is_own(const hal::CanFrame& frame) const noexcept {
    return is_sync(frame) || frame.id == own_heartbeat_;
  }
  // Somebody else commands the node by the PDO that is ours, or writes to it by SDO. Whoever only reads does no harm.
  static constexpr bool is_command(const hal::CanFrame& frame, std::uint8_t node_id) noexcept {
    if (frame.id == rpdo_cob_id(1, node_id)) return !frame.remote;
    constexpr unsigned initiate_download = 1, block_download = 6;
    const unsigned specifier = frame.data[0] >> 5U;
    return frame.id == sdo_request_cob_id(node_id) && (specifier == initiate_download || specifier == block_download);
  }
  // From the start of a period to its SYNC: canopen::sync_offset() says how long.
  static constexpr hal::Duration sync_offset(unsigned axes, const hal::NetworkConfig& network) noexcept {
    return canopen::sync_offset(axes, network.period, network.bit_rate);
  }
  // These return true and fill `frame` when one is to be sent now: behind the commands, and in the room that a period
  // has for what is not cyclic.
  static constexpr bool next_sync(hal::CanFrame& frame) noexcept {
    frame = sync_frame();
    return true;
  }
  constexpr bool next_heartbeat(hal::CanFrame& frame, hal::Time now) noexcept {
    return heartbeat_.next_frame(frame, NmtState::operational, now);
  }

 private:
  std::uint16_t own_heartbeat_;
  HeartbeatProducer heartbeat_;
};

}  // namespace breakaway::canopen
