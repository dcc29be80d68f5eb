// The picture of a basin: light attracted, dark lost, with the equilibrium set E and the certified region B drawn in.
#pragma once

#include <string>

#include "breakaway/design/equilibrium_set.hpp"
#include "breakaway/machine/basin.hpp"
#include "breakaway/machine/certificates.hpp"

namespace breakaway::machine {

// E and B of a machine in the plane and window of a grid.
struct Regions {
  design::Polygon equilibria;  // E: a polygon, a segment or a point
  design::Polygon certified;   // B = { V < rho* }; the whole window when rho* is infinite, empty when it is 0
};

Regions regions(const plant::LinearMachine<>& machine, const Certificates& certificates, const Grid& grid);

// The content of the file `path`, an .svg or a .png. Throws scenario::InputError as report::draw_file.
std::string draw_basin(const std::string& path, const scenario::MachineScenario& scenario, const Basin& basin,
                       const Regions& regions);

}  // namespace breakaway::machine
