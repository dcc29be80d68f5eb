#include "breakaway/watch/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace breakaway::watch {

void History::add(Sample sample) {
  const std::scoped_lock lock{mutex_};
  if (std::ranges::find(axes_, sample.axis) == axes_.end()) {
    if (axes_.size() == most_axes) {
      ++losses_.malformed;
      losses_.complaint = fmt::format("there are more than {} axes; give each its own breakaway watch", most_axes);
      return;
    }
    axes_.push_back(sample.axis);
  }
  samples_.push_back(std::move(sample));
  ++added_;
  if (samples_.size() > most_) samples_.pop_front();
}

void History::complain(std::string why) {
  const std::scoped_lock lock{mutex_};
  ++losses_.malformed;
  losses_.complaint = std::move(why);
}

void History::set_lost_at_sender(std::uint64_t samples) {
  const std::scoped_lock lock{mutex_};
  losses_.at_sender = samples;
}

void History::add_lost_on_the_way(std::uint64_t samples) {
  const std::scoped_lock lock{mutex_};
  losses_.on_the_way += samples;
}

Excerpt History::read(std::uint64_t from, std::size_t most) const {
  const std::scoped_lock lock{mutex_};
  const std::uint64_t oldest = added_ - samples_.size();
  const std::uint64_t begin = std::clamp(from, oldest, added_);
  const std::uint64_t end = begin + std::min<std::uint64_t>(most, added_ - begin);
  const auto at = [&](std::uint64_t number) { return samples_.begin() + static_cast<std::ptrdiff_t>(number - oldest); };
  return {.samples = {at(begin), at(end)}, .next = end, .more = end < added_, .axes = axes_, .losses = losses_};
}

Losses History::losses() const {
  const std::scoped_lock lock{mutex_};
  return losses_;
}

}  // namespace breakaway::watch
