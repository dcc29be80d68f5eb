// --readonly: follows what another master and the drives say; sends nothing.
#pragma once

#include "breakaway/socketcan/kernel_socket.hpp"
#include "configuration.hpp"
#include "options.hpp"
#include "telemetry.hpp"

namespace breakaway::linux_node {

// Until the operator or --duration ends it. Failed: nothing was heard of the drives.
ExitCode listen(const Configuration& configuration, const Options& options, socketcan::KernelSocket& socket,
                Telemetry& telemetry);

}  // namespace breakaway::linux_node
