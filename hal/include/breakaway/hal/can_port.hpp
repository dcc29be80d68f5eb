// CanPort: a node's door to one CAN bus. Ports never block, never allocate after construction and never throw; every
// call may be made from the control loop's thread only.
#pragma once

#include <concepts>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/status.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

enum class BusState : std::uint8_t { error_active, error_warning, error_passive, bus_off };

// send: queues the frame behind those of earlier calls (first in, first out) or says why not (queue_full, bus_off). A
// frame
//   that is not on the wire by `deadline` is dropped by the port: a stale command must not be executed.
// receive: takes the oldest received frame; false when there is none.
// purge_transmit_queue: forgets every frame not yet on the wire; called on faults and on recovery from bus-off.
template <class P>
concept CanPort = requires(P& port, const CanFrame& frame, ReceivedFrame& received, Time deadline) {
  { port.send(frame, deadline) }
  noexcept->std::same_as<Status>;
  { port.receive(received) }
  noexcept->std::same_as<bool>;
  { port.purge_transmit_queue() }
  noexcept->std::same_as<void>;
  { port.bus_state() }
  noexcept->std::same_as<BusState>;
};

}  // namespace breakaway::hal
