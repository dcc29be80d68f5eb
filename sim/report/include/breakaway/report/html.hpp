// The report that people read: one HTML file with its pictures inside, for browsers without a network.
#pragma once

#include <string>

#include "breakaway/scenario/result.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::report {

// Requires a recorded trace. Throws scenario::InputError when gnuplot, which draws the pictures, cannot be run.
std::string to_html(const scenario::Scenario& scenario, const scenario::Result& result);

}  // namespace breakaway::report
