// What the controller's image tells of a run, as it lies in the file.
#pragma once

#include <cstdint>

namespace breakaway::emulated {

inline constexpr std::uint32_t ticks_to_run = 10'000;

struct ControllerReport {
  std::uint32_t start_result = 0;
  std::uint32_t ticks = 0;
  std::uint32_t missed = 0;       // no step began in that period
  std::uint32_t late = 0;         // steps that were not over before the next tick
  std::uint32_t lost_frames = 0;  // dropped at their deadline, or by a full receive FIFO
};

}  // namespace breakaway::emulated
