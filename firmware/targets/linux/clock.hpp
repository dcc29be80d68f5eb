// The clock that a node lives by. Alone in its object file, so that a program with a clock of its own can have its
// definitions in place of these.
#pragma once

#include "breakaway/hal/time.hpp"

namespace breakaway::linux_node {

hal::Time monotonic_now() noexcept;

// Returns the time then. A sleep that ends early, by a signal or because it is refused, begins again: a loop that ran
// ahead of its periods would have pulses of the wrong length.
hal::Time sleep_until(hal::Time time) noexcept;

}  // namespace breakaway::linux_node
