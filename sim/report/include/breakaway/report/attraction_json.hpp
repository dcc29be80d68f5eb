// What is proved of a machine's equilibrium set, as text for other programs. SI units; names carry them.
#pragma once

#include <string>

#include "breakaway/report/basin_picture.hpp"
#include "breakaway/study/attraction.hpp"

namespace breakaway::report {

// E and B in the plane of the certified region; both empty where nothing is certified.
Regions regions(const stability::LinearMachine<>& machine, const study::Attraction& found);

std::string to_json(const scenario::MachineScenario& scenario, const study::Attraction& found);

}  // namespace breakaway::report
