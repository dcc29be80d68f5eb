// A scene behind a drive on a CAN bus.
#pragma once

#include "breakaway/scenario/result.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// Runs the flashed control loop against the drive emulator and the plant, in virtual time. Requires scenario.loop,
// .drive, .bus and .run. Throws InputError when the configuration cannot work (the bus is too slow for the period, for
// example).
Result run_bus_scene(const Scenario& scenario, const RecordingOptions& recording);

// Throws InputError with the figures when the control period is too short for the bus. A scene without [loop] or [bus]
// fits.
void require_fitting_bus(const Scenario& scenario);

}  // namespace breakaway::scenario
