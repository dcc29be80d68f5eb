#pragma once

#include "breakaway/scenario/machine_scenario.hpp"

// The example of section 4 of van de Wouw & Leine on equilibrium sets.
inline breakaway::scenario::MachineScenario two_masses() {
  return breakaway::scenario::read_machine_scenario(BREAKAWAY_SOURCE_DIR "/sim/scenarios/two_mass_example.toml");
}
