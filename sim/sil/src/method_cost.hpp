// What a run of a method costs, from what it counts: the one place with measured constants. A choice by these does not
// depend on how busy the machine is, so that it is the same every time.
#pragma once

#include "machine_end.hpp"

namespace breakaway::sil {

// Processor time (s) of a run with these steps, setting up included. Measured on one core of an x86-64 PC (release
// build, GCC 12) on random machines of 1 to 12 coordinates with as many directions: within a factor of 1.5 there, and
// elsewhere in proportion.
double run_cost_s(const scenario::MachineScenario& scenario, const Method& method, double steps);

inline double run_cost_s(const scenario::MachineScenario& scenario, const Method& method, const MachineEnd& end) {
  return run_cost_s(scenario, method, static_cast<double>(end.steps));
}

}  // namespace breakaway::sil
