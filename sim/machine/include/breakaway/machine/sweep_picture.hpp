// B and E of one machine under several gains of velocity: Figure 4 of van de Wouw & Leine, "Stability Properties of
// Equilibrium Sets of Controlled Linear Mechanical Systems with Dry Friction".
#pragma once

#include <string>
#include <vector>

#include "breakaway/plant/linear_machine.hpp"

namespace breakaway::machine {

struct SweptMachine {
  double velocity_gain_Ns_per_m;
  plant::LinearMachine<> closed_loop;
};

// The content of the file `path`, an .svg or a .png: the plane of the first two coordinates at rest, or of q and v for
// a machine of one coordinate. The window holds the largest B that is not everything, else E with room around it. At
// least one machine, all of one size and stiffness. Throws scenario::InputError as report::draw_file.
std::string draw_sweep(const std::string& path, const std::vector<SweptMachine>& machines);

}  // namespace breakaway::machine
