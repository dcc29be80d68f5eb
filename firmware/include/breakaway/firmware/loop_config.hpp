// LoopConfig: what a control loop is told of itself; of its axes it is told when they are added.
#pragma once

#include <cstdint>

#include "breakaway/canopen/network_config.hpp"
#include "breakaway/firmware/fault_scope.hpp"

namespace breakaway::firmware {

struct LoopConfig {
  canopen::NetworkConfig network{};
  FaultScope fault_scope = FaultScope::axis;
};

}  // namespace breakaway::firmware
