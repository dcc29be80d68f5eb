// What pictures have in common, most of it those of planes of a machine's state space.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "breakaway/report/basin_picture.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::report {

// Of the lines of an axis or coordinate, from 0 on, in all pictures.
const char* line_colour(std::size_t place);

// gnuplot's settings: frame, key, square axes; and the labels and ranges of the axes, from -rim to rim.
std::string plane_style(const stability::LinearMachine<>& machine, const std::array<int, 2>& plane, double rim);

// A data block $name of the polygon's corners, closed. A few hundred corners are an ellipse to the eye.
std::string outline(std::string_view name, const stability::Polygon& polygon);

// The data blocks of B and E, and the parts of the plot command that draw them, each begun by a comma.
std::string region_outlines(const Regions& regions);
std::string plot_regions(const Regions& regions);

// As format::draw_file; an image in an .svg is not blurred by the viewer.
std::string draw_plane(const std::string& path, const std::string& commands);

}  // namespace breakaway::report
