// Ring: a queue in storage that is allocated once.
#pragma once

#include <cstddef>
#include <vector>

namespace breakaway::virtual_bus {

template <class T>
class Ring {
 public:
  explicit Ring(std::size_t capacity) : items_(capacity) {}

  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  void clear() noexcept { size_ = 0; }

  // Returns false, and changes nothing, when the ring is full.
  bool push(const T& item) noexcept {
    if (size_ == items_.size()) return false;
    items_[(first_ + size_) % items_.size()] = item;
    ++size_;
    return true;
  }

  // The ring must not be empty for these two.
  const T& front() const noexcept { return items_[first_]; }
  void pop() noexcept {
    first_ = (first_ + 1) % items_.size();
    --size_;
  }

 private:
  std::vector<T> items_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace breakaway::virtual_bus
