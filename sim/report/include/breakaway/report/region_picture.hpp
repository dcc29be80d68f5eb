// The picture of a certified region: what is proved to be attracted and to be lost, the border between them, and in it
// the region of attraction by simulation.
#pragma once

#include <string>

#include "breakaway/report/basin_picture.hpp"
#include "breakaway/study/certified_region.hpp"

namespace breakaway::report {

// The content of the file `path`, an .svg or a .png. `regions` are E and B in the region's window. Throws
// InputError as format::draw_file.
std::string draw_region(const std::string& path, const scenario::MachineScenario& scenario,
                        const study::CertifiedRegion& region, const Regions& regions);

}  // namespace breakaway::report
