// ServedPort: a CanPort that takes the SDO requests to this node out of what another port receives, for its SdoServer.
#pragma once

#include <cstdint>

#include "breakaway/canopen/sdo_server.hpp"
#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::firmware {

template <hal::CanPort Port>
class ServedPort {
 public:
  ServedPort(Port& port, std::uint8_t node_id) noexcept : port_{&port}, server_{node_id} {}

  hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept { return port_->send(frame, deadline); }
  bool receive(hal::ReceivedFrame& received) noexcept {
    while (port_->receive(received)) {
      if (!server_.on_frame(received.frame)) return true;
    }
    return false;
  }
  void purge_transmit_queue() noexcept { port_->purge_transmit_queue(); }
  hal::BusState bus_state() const noexcept { return port_->bus_state(); }

  canopen::SdoServer& server() noexcept { return server_; }

 private:
  Port* port_;
  canopen::SdoServer server_;
};

}  // namespace breakaway::firmware
