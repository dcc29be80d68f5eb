// LoopConfig: what a control loop is told of itself; of its axes it is told when they are added.
#pragma once

#include <chrono>
#include <cstdint>

#include "breakaway/firmware/fault_scope.hpp"
#include "breakaway/firmware/moves_end.hpp"
#include "breakaway/hal/network_config.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::firmware {

struct LoopConfig {
  hal::NetworkConfig network{};
  FaultScope fault_scope = FaultScope::axis;
  MovesEnd moves_end = MovesEnd::each;
  // A ControlNode stops an axis whose commander says nothing for longer.
  hal::Duration command_timeout = std::chrono::milliseconds{500};
};

}  // namespace breakaway::firmware
