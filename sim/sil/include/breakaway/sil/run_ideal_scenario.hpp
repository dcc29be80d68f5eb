// A scenario under the ideal law of [I]: continuous feedback, and an impulse at each instant of rest.
#pragma once

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

// Ends when the bound (19) on the time that is left has fallen below the resolution of time itself, so that no number
// of kicks and no distance is chosen by hand; or at run.duration_s, then settled is false. Requires
// scenario.controller.impulsive and .run, and no .loop.
Result run_ideal_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording);

}  // namespace breakaway::sil
