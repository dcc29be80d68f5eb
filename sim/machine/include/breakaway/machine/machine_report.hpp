// The motion of a machine for other programs and for people.
#pragma once

#include <string>

#include "breakaway/machine/run_machine.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::machine {

// Both require a recorded trace.

// One line a state, with a header line: time_s, q1.., v1.., and for each friction slides1..: the sign of its sliding
// velocity, 0 while that is zero.
std::string to_csv(const scenario::MachineScenario& scenario, const MachineResult& result);

// One HTML page with the outcome, q and v over time. Throws scenario::InputError when gnuplot, which draws, cannot be
// run.
std::string to_html(const scenario::MachineScenario& scenario, const MachineResult& result);

}  // namespace breakaway::machine
