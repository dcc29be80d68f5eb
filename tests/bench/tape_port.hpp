// A CanPort without a bus: receives what was laid in, keeps what was sent. It costs a step next to nothing, so that a
// count of the loop is a count of the loop.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"

namespace breakaway::bench {

class TapePort {
 public:
  // For the next step. The frames must outlive it.
  void lay_in(std::span<const hal::ReceivedFrame> frames) noexcept {
    inbox_ = frames;
    sent_ = 0;
  }
  std::span<const hal::CanFrame> sent() const noexcept { return std::span{outbox_}.first(sent_); }

  [[nodiscard]] hal::SendResult send(const hal::CanFrame& frame, hal::Time) noexcept {
    if (sent_ == outbox_.size()) return hal::SendResult::queue_full;
    outbox_[sent_++] = frame;
    return hal::SendResult::queued;
  }
  bool receive(hal::ReceivedFrame& received) noexcept {
    if (inbox_.empty()) return false;
    received = inbox_.front();
    inbox_ = inbox_.subspan(1);
    return true;
  }
  void purge_transmit_queue() noexcept { sent_ = 0; }
  hal::BusState bus_state() const noexcept { return hal::BusState::error_active; }

 private:
  std::span<const hal::ReceivedFrame> inbox_;
  std::array<hal::CanFrame, 64> outbox_{};
  std::size_t sent_ = 0;
};

static_assert(hal::CanPort<TapePort>);

}  // namespace breakaway::bench
