// The picture of a certified region: what is proved to be attracted and to be lost, the border between them, and in it
// the region of attraction by simulation.
#pragma once

#include <string>

#include "breakaway/machine/basin_picture.hpp"
#include "breakaway/machine/certified_region.hpp"

namespace breakaway::machine {

// The content of the file `path`, an .svg or a .png. `regions` are E and B in the region's window. Throws
// scenario::InputError as report::draw_file.
std::string draw_region(const std::string& path, const scenario::MachineScenario& scenario,
                        const CertifiedRegion& region, const Regions& regions);

}  // namespace breakaway::machine
