// The report that people read: one HTML file with its pictures inside, for browsers without a network.
#pragma once

#include <string>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::report {

// Requires a recorded trace. Throws InputError when gnuplot, which draws the pictures, cannot be run.
std::string to_html(const scenario::Scenario& scenario, const sil::Result& result);

}  // namespace breakaway::report
