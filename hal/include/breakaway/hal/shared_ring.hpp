// SharedRing: a queue between an interrupt and the loop without a lock. One side only pushes and the other only pops;
// each may do so while the other is at it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace breakaway::hal {

template <class Item, std::uint32_t Capacity>
class SharedRing {
 public:
  // Copies the item behind the others. Returns false, and keeps nothing, when the ring is full.
  bool push(const Item& item) noexcept {
    const std::uint32_t end = end_.load(std::memory_order_relaxed);
    if (end - begin_.load(std::memory_order_acquire) == Capacity) return false;
    items_[end % Capacity] = item;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }
  // Moves the oldest item to `item`. Returns false, and changes nothing, when the ring is empty.
  bool pop(Item& item) noexcept {
    const std::uint32_t begin = begin_.load(std::memory_order_relaxed);
    if (begin == end_.load(std::memory_order_acquire)) return false;
    item = items_[begin % Capacity];
    begin_.store(begin + 1, std::memory_order_release);
    return true;
  }

 private:
  static_assert((Capacity & (Capacity - 1)) == 0, "the counters wrap at 2^32, which Capacity must divide");
  std::array<Item, Capacity> items_{};
  std::atomic<std::uint32_t> begin_{0}, end_{0};
};

}  // namespace breakaway::hal
