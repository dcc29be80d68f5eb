// What tuning tried, chose and found to limit an axis, as text for other programs. SI units; names carry them.
#pragma once

#include <string>

#include "breakaway/study/tune.hpp"

namespace breakaway::report {

std::string to_json(const study::Tuning& tuning);

}  // namespace breakaway::report
