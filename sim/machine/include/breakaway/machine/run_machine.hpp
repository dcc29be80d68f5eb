// One motion of a machine: `breakaway simulate` on a scenario with a [machine].
#pragma once

#include <string>
#include <vector>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::machine {

struct MachineResult {
  hybrid::Outcome<Eigen::Dynamic> outcome;
  std::vector<hybrid::Event> events;
  std::vector<std::vector<int>> modes;  // in order: for each direction the sign of its sliding, 0 while it sticks
  hybrid::Verdict proved = hybrid::Verdict::undecided;  // of the start: captured or lost by a certificate
  std::string warning;                                  // why the figures may be wrong; empty if nothing is known

  bool settled() const { return outcome.verdict == hybrid::Verdict::at_rest; }
};

// From scenario.start to rest or to duration_s. Throws scenario::InputError when the scenario has no start, or the
// integrator cannot take the machine.
MachineResult run_machine(const scenario::MachineScenario& scenario);

std::string to_json(const scenario::MachineScenario& scenario, const MachineResult& result);

}  // namespace breakaway::machine
