// The one way into the simulation: whatever the scenario names is simulated, and nothing else.
#pragma once

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/result.hpp"
#include "breakaway/sil/run_machine.hpp"

namespace breakaway::sil {

// Throws InputError when parts of the scenario are missing or do not fit together: what a simulation needs beyond what
// read_scenario asks of every file.
void require_complete(const scenario::Scenario& scenario);

// Throws InputError as require_complete does, and when the scenario cannot run on its bus.
Result run_scenario(const scenario::Scenario& scenario, const RecordingOptions& recording);

// A machine has no bus, so that there are no frames to record.
inline MachineResult run_scenario(const scenario::MachineScenario& scenario, const RecordingOptions& recording) {
  return run_machine(scenario, recording);
}

}  // namespace breakaway::sil
