// Why a node does not run, for a debugger to read: `start_result` in the image's symbols.
#pragma once

#include <cstdint>

namespace breakaway::stm32f405 {

enum class StartResult : std::uint32_t {
  not_started,
  running,
  configuration_refused,  // setup_detail says why (ControlNode::setup_status)
  no_crystal,             // CAN needs better than 0.5 %; check BREAKAWAY_CRYSTAL_HZ and the board
  rate_impossible,        // this bit or baud rate cannot be made of the clock
  period_impossible,      // longer than the tick timer counts
  no_idle_bus,            // the CAN controller sees no 11 recessive bits: check transceiver, wiring, termination
};

inline constinit volatile StartResult start_result = StartResult::not_started;
inline constinit volatile std::uint32_t setup_detail = 0;

}  // namespace breakaway::stm32f405
