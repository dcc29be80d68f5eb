// The last few values of a function that depends on its key alone.
//
// A certificate, the header that is flashed, a run and a study all ask for the design of the same axis, and tuning asks
// for it at each speed of its approach, which it does not depend on.
#pragma once

#include <array>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

namespace breakaway::design::detail {

// For any number of threads.
template <class Key, class Value>
class Memo {
 public:
  // make(key), which is called without a lock where it is not known.
  template <class Make>
  Value of(const Key& key, const Make& make) {
    if (std::optional<Value> known = find(key)) return *std::move(known);
    Value made = make(key);
    keep(key, made);
    return made;
  }

 private:
  std::optional<Value> find(const Key& key) {
    const std::scoped_lock lock{mutex_};
    for (const auto& kept : kept_)
      if (kept && kept->first == key) return kept->second;
    return std::nullopt;
  }
  void keep(const Key& key, const Value& value) {
    const std::scoped_lock lock{mutex_};
    kept_[oldest_].emplace(key, value);
    oldest_ = (oldest_ + 1) % kept_.size();
  }

  std::mutex mutex_;
  std::array<std::optional<std::pair<Key, Value>>, 16> kept_{};
  std::size_t oldest_ = 0;
};

}  // namespace breakaway::design::detail
