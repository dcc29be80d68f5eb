// Clock: where `now` comes from. Only main() and whatever paces the loop ask it; logic gets the time as an argument.
#pragma once

#include <concepts>

#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

// The formatter would tear the requirement apart.
// clang-format off

template <class C>
concept Clock = requires(const C& clock) {
  // Returns the time since the clock's epoch. It never decreases and never blocks, and may be called in an interrupt.
  { clock.now() } noexcept -> std::same_as<Time>;
};

// clang-format on

}  // namespace breakaway::hal
