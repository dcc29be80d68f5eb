// OutgoingQueue: the frames that wait to be sent, first in, first out.
#pragma once

#include <array>
#include <cstddef>

#include "breakaway/hal/can_frame.hpp"

namespace breakaway::socketcan {

struct Outgoing {
  hal::CanFrame frame;
  hal::Time deadline{};
};

template <std::size_t Capacity>
class OutgoingQueue {
 public:
  // Returns false, and keeps nothing, when the queue is full.
  bool push(const Outgoing& outgoing) noexcept {
    if (count_ == Capacity) return false;
    items_[(first_ + count_++) % Capacity] = outgoing;
    return true;
  }
  bool empty() const noexcept { return count_ == 0; }
  // The queue must not be empty for these two.
  const Outgoing& front() const noexcept { return items_[first_]; }
  void pop() noexcept {
    first_ = (first_ + 1) % Capacity;
    --count_;
  }
  void clear() noexcept { count_ = 0; }

 private:
  std::array<Outgoing, Capacity> items_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace breakaway::socketcan
