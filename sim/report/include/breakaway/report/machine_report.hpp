// The motion of a machine for other programs and for people.
#pragma once

#include <string>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/run_machine.hpp"

namespace breakaway::report {

std::string to_json(const scenario::MachineScenario& scenario, const sil::MachineResult& result);

// Both require a recorded trace.

// One line a state, with a header line: time_s, q1.., v1.., and for each friction slides1..: the sign of its sliding
// velocity, 0 while that is zero.
std::string to_csv(const scenario::MachineScenario& scenario, const sil::MachineResult& result);

// One HTML page with the outcome, q and v over time. Throws InputError when gnuplot, which draws, cannot be
// run.
std::string to_html(const scenario::MachineScenario& scenario, const sil::MachineResult& result);

}  // namespace breakaway::report
