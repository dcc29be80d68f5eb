// A judgement in a process of its own, for long campaigns: where the method never ends, the process does, and
// everything else goes on.
#pragma once

#include <functional>

#include "machine_comparison.hpp"

namespace breakaway::campaign {

// Calls `judge` in this process if `apart` is false.
Judgement isolated(bool apart, const std::function<Judgement()>& judge);

}  // namespace breakaway::campaign
