// NetworkConfig: what every node on a CANopen bus has to agree on with its master.
#pragma once

#include "breakaway/hal/network_config.hpp"

namespace breakaway::canopen {

using hal::NetworkConfig;

}  // namespace breakaway::canopen
