// Why a node does not run, for a debugger to read: `start_result` in the image's symbols.
#pragma once

#include <cstdint>

namespace breakaway::zynqmp_r5 {

enum class StartResult : std::uint32_t {
  not_started,
  running,
  configuration_refused,  // setup_detail says why (ControlNode::setup_status)
  rate_impossible,        // this bit rate cannot be made of BREAKAWAY_CAN_HZ
  no_idle_bus,            // the CAN controller has no clock or sees no 11 recessive bits
  period_impossible,      // not a whole number of cycles of BREAKAWAY_CORE_HZ, or too long for the watchdog
};

inline constinit volatile StartResult start_result = StartResult::not_started;
inline constinit volatile std::uint32_t setup_detail = 0;

}  // namespace breakaway::zynqmp_r5
