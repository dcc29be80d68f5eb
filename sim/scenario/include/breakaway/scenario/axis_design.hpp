// A scene's axis as controller/design examines it.
#pragma once

#include "breakaway/design/report.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// Throws InputError with the figures when the control period is too short for the bus. A scenario without [loop] or
// [bus] fits.
void require_fitting_bus(const Scenario& s);

// Throws InputError: a PID, no accuracy asked for, a period too short for the bus.
design::AxisDesign axis_design(const Scenario& s);

}  // namespace breakaway::scenario
