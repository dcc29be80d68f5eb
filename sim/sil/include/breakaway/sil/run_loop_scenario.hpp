// Axes behind drives on a CAN bus.
#pragma once

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

// Runs the flashed control loop against the drive emulators and their axes, in virtual time. Requires scenario.run and
// node.loop, and of every axis a drive. Throws InputError when the configuration cannot work: a bus that is too slow
// for the period, for example.
Result run_loop_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording);

}  // namespace breakaway::sil
