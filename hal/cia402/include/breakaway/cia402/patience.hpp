// With how much patience a drive's SDO server is asked: some take a second for an answer, what got no answer in time
// must be asked again, because frames are lost, and some refuse what they do later.
#pragma once

#include <algorithm>
#include <chrono>

#include "breakaway/canopen/sdo_abort.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

inline constexpr int growth_of_patience = 6;
inline constexpr hal::Duration longest_patience = std::chrono::seconds{2};

// For the next attempt, after one that got no answer within `patience` (> 0). What was longer from the first stays so.
constexpr hal::Duration grown(hal::Duration patience) noexcept {
  return std::max(patience, std::min<hal::Duration>(patience * growth_of_patience, longest_patience));
}

// Whether a drive may take later what it refuses now: its server is not ready, or somebody else still uses it.
constexpr bool may_pass(canopen::SdoAbort refusal) noexcept {
  switch (refusal) {
    case canopen::SdoAbort::timeout:
    case canopen::SdoAbort::out_of_memory:
    case canopen::SdoAbort::cannot_store:
    case canopen::SdoAbort::local_control:
    case canopen::SdoAbort::device_state:
      return true;
    default:
      return false;
  }
}

}  // namespace breakaway::cia402
