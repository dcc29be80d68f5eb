// What an experiment found of an axis, as a page with pictures and as JSON.
#pragma once

#include <string>

#include "breakaway/study/identification.hpp"

namespace breakaway::report {

// Throws InputError when gnuplot cannot be run.
std::string identification_html(const study::IdentifiedRun& run);

std::string identification_json(const study::IdentifiedRun& run);

}  // namespace breakaway::report
