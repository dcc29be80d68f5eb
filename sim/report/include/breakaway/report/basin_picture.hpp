// The picture of a basin: light attracted, dark lost, with the equilibrium set E and the certified region B drawn in.
#pragma once

#include <string>

#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "breakaway/study/basin.hpp"

namespace breakaway::report {

// E and B of a machine in the plane and window of a grid.
struct Regions {
  stability::Polygon equilibria;  // E: a polygon, a segment or a point
  stability::Polygon certified;   // B = { V < rho* }; the whole window when rho* is infinite, empty when it is 0
};

Regions regions(const stability::LinearMachine<>& machine, const sil::Certificates& certificates,
                const study::Grid& grid);

// The content of the file `path`, an .svg or a .png. Throws InputError as format::draw_file.
std::string draw_basin(const std::string& path, const scenario::MachineScenario& scenario, const study::Basin& basin,
                       const Regions& regions);

}  // namespace breakaway::report
