// Clock: where `now` comes from. Only main() and the loop's pacer ask it; logic gets the time as an argument.
#pragma once

#include <concepts>

#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

template <class C>
concept Clock = requires(const C& clock) {
  { clock.now() }
  noexcept->std::same_as<Time>;  // monotonic, never blocks, safe in an interrupt
};

}  // namespace breakaway::hal
