// B and E of one machine under several gains of velocity: Figure 4 of van de Wouw & Leine, "Stability Properties of
// Equilibrium Sets of Controlled Linear Mechanical Systems with Dry Friction".
#pragma once

#include <string>
#include <vector>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::report {

struct SweptMachine {
  double velocity_gain_Ns_per_m;
  stability::LinearMachine<> closed_loop;
};

// The content of the file `path`, an .svg or a .png: the plane of the first two coordinates at rest, or of q and v for
// a machine of one coordinate. The window holds the largest B that is not everything, else E with room around it. At
// least one machine, all of one size and stiffness. Throws InputError as format::draw_file.
std::string draw_sweep(const std::string& path, const std::vector<SweptMachine>& machines);

}  // namespace breakaway::report
