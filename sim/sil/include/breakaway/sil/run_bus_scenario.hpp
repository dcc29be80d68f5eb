// A scene behind a drive on a CAN bus.
#pragma once

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

// Runs the flashed control loop against the drive emulator and the plant, in virtual time. Requires scenario.loop,
// .drive, .bus and .run. Throws InputError when the configuration cannot work (the bus is too slow for the period, for
// example).
Result run_bus_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording);

}  // namespace breakaway::sil
