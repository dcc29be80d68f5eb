// Tuning: the worst settling time over the gains that were tried, and what limits it.
#pragma once

#include <string>

#include "breakaway/study/tune.hpp"

namespace breakaway::report {

// The content of the file `path`, an .svg or a .png. Above, each set of gains that settles at its speed of approach, or
// at its frequency sqrt(k1 / m) where no speed is limited; below, what each number of the axis, twice as good, comes
// to. Throws InputError as format::draw_file.
std::string draw_tuning(const std::string& path, const study::Tuning& tuning);

}  // namespace breakaway::report
