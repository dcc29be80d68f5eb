// The best end of a motion that there is, by which all others are judged.
#pragma once

#include <optional>
#include <vector>

#include "machine_end.hpp"

namespace breakaway::sil {

struct BestEnd {
  MachineEnd end;
  double error_m = 0;  // of `end`, estimated
  Method method;       // that gave it
};

// `refused` takes the methods that could not. Nothing: none could. Time stepping is extrapolated only as far as
// accuracy_m asks.
std::optional<BestEnd> best_end(const scenario::MachineScenario& scenario, double accuracy_m,
                                std::vector<MethodRefusal>& refused);

// What is said of a method that the machine is too much for.
MethodRefusal cannot_follow(scenario::Integrator integrator, const InputError& error);

// Ends of time stepping with the motion begun at several places of the first step, the last one at its beginning.
std::vector<MachineEnd> ends_by_time_steps(const scenario::MachineScenario& scenario, double step_s);

}  // namespace breakaway::sil
