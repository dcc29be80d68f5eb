// Pictures by gnuplot, which runs as a process of its own.
#pragma once

#include <string>

namespace breakaway::format {

// The drawing that the commands make, as an <svg> element. Throws InputError naming the package to install
// when gnuplot cannot be run, and with gnuplot's own words when it refuses the commands.
std::string draw_svg(const std::string& name, int width_px, int height_px, const std::string& commands);

// The drawing as the content of the file `path`, whose name ends in .svg or .png. Throws as draw_svg does.
std::string draw_file(const std::string& path, int width_px, int height_px, const std::string& commands);

// Throws InputError unless draw_file knows the ending of `path`: to be asked before the work begins.
void require_picture_ending(const std::string& path);

}  // namespace breakaway::format
