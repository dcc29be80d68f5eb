// A CAN port that keeps what is sent and gives what was put into its inbox.
#pragma once

#include <deque>
#include <vector>

#include "breakaway/hal/can_port.hpp"

namespace breakaway::firmware {

struct ListedPort {
  std::vector<hal::CanFrame> sent;
  std::vector<hal::Time> deadlines;  // of the frames that were sent
  std::deque<hal::ReceivedFrame> inbox;
  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time deadline) noexcept {
    sent.push_back(frame);
    deadlines.push_back(deadline);
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (inbox.empty()) return false;
    received = inbox.front();
    inbox.pop_front();
    return true;
  }
  void purge_transmit_queue() noexcept {}
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }
};

}  // namespace breakaway::firmware
