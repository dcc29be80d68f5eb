// The results of a scene as text for other programs. SI units; names carry them.
#pragma once

#include <string>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::report {

// All figures and kicks, without samples and frames.
std::string to_json(const scenario::Scenario& scene, const sil::Result& result);

// One line a sample, with a header line. Requires a recorded trace.
std::string to_csv(const sil::Result& result);

// The log format of candump -L, which can-utils and Wireshark read: (seconds.microseconds) can0 ID#DATA. Requires
// recorded frames.
std::string to_candump(const sil::Result& result);

}  // namespace breakaway::report
