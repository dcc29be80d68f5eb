// NetworkConfig: what every node on a CANopen bus has to agree on with its master.
#pragma once

#include <chrono>
#include <cstdint>

#include "breakaway/hal/time.hpp"

namespace breakaway::canopen {

struct NetworkConfig {
  hal::Duration period{};              // of SYNC, and so of the control loop; above 0
  std::uint32_t bit_rate = 1'000'000;  // bit/s
  std::uint8_t node_id = 127;          // the master's own, 1..127: drives expect its heartbeat under this id
  hal::Duration heartbeat_period = std::chrono::milliseconds{50};  // of the master; 0: it produces none
};

}  // namespace breakaway::canopen
