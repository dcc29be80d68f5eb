// The results of a scenario as text for other programs. SI units; names carry them.
#pragma once

#include <string>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::report {

// All figures and kicks, without samples and frames. A scenario of several axes has an overall `settled` and the
// figures of each axis under `axes`; one of a single axis has them at the top.
std::string to_json(const scenario::Scenario& scenario, const sil::Result& result);

// One line a sample, with a header line; of several axes one after the other, named in the first column. Requires a
// recorded trace.
std::string to_csv(const scenario::Scenario& scenario, const sil::Result& result);

// The log format of candump -L, which can-utils and Wireshark read: (seconds.microseconds) can0 ID#DATA. Requires
// recorded frames.
std::string to_candump(const sil::Result& result);

}  // namespace breakaway::report
