// Pictures by gnuplot, which runs as a process of its own.
#pragma once

#include <string>

namespace breakaway::report {

// The drawing that the commands make, as an <svg> element. Throws scenario::InputError naming the package to install
// when gnuplot cannot be run, and with gnuplot's own words when it refuses the commands.
std::string draw_svg(const std::string& name, int width_px, int height_px, const std::string& commands);

}  // namespace breakaway::report
