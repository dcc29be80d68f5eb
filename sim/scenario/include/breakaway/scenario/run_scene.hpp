// The one way into the simulation: whatever the scene names is simulated, and nothing else.
#pragma once

#include "breakaway/scenario/result.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::scenario {

// Throws InputError when parts of the scene are missing or do not fit together.
Result run_scene(const Scenario& scenario, const RecordingOptions& recording);

}  // namespace breakaway::scenario
