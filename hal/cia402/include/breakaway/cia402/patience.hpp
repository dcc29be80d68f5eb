// How long a drive's SDO server is waited for: some take a second for an answer, and one that got no answer in time must
// be asked again, because frames are lost.
#pragma once

#include <algorithm>
#include <chrono>

#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

inline constexpr int growth_of_patience = 6;
inline constexpr hal::Duration longest_patience = std::chrono::seconds{2};

// For the next attempt, after one that got no answer within `patience` (> 0). What was longer from the first stays so.
constexpr hal::Duration grown(hal::Duration patience) noexcept {
  return std::max(patience, std::min<hal::Duration>(patience * growth_of_patience, longest_patience));
}

}  // namespace breakaway::cia402
