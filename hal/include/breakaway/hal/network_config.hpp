// NetworkConfig: what every node on a bus has to agree on with its master.
#pragma once

#include <chrono>
#include <cstdint>

#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

struct NetworkConfig {
  Duration period{};                   // of the control loop, and of SYNC where there is one; above 0
  std::uint32_t bit_rate = 1'000'000;  // bit/s
  // The rest is for protocols whose master is a node of its own, as in CANopen.
  std::uint8_t node_id = 127;  // the master's own, 1..127: drives expect its heartbeat under this id
  Duration heartbeat_period = std::chrono::milliseconds{50};  // of the master; 0: it produces none
};

}  // namespace breakaway::hal
