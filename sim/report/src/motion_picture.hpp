// The motion of a machine as a picture.
#pragma once

#include <string>
#include <vector>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::report {

// Coordinates and velocities over time, as SVG. The trace is not empty; of a long one some thousand states are drawn.
// Throws InputError when gnuplot cannot be run.
std::string draw_motion(const std::vector<stability::MachineState<Eigen::Dynamic>>& trace);

}  // namespace breakaway::report
