// A judgement in a process of its own, for long campaigns: one that never ends is killed after so many seconds of
// processor time, and everything else goes on.
#pragma once

#include <functional>

#include "machine_comparison.hpp"

namespace breakaway::campaign {

// Calls `judge` in this process for cpu_s <= 0.
Judgement isolated(long cpu_s, const std::function<Judgement()>& judge);

}  // namespace breakaway::campaign
