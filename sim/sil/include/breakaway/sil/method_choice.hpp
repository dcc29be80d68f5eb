// The cheapest method that follows a machine's motion to the accuracy asked for.
//
// Every method is tried on the motion itself, and its error is the distance of its end from the best end there is:
//   - the event-driven one, which is exact but for rounding; rounding is judged by the same motion in other units;
//   - under friction laws, which that method does not know, the adaptive one at a tolerance of 1e-13, whose own error
//   is
//     judged by what tolerances near it give;
//   - with more than 16 directions, which neither takes, time stepping extrapolated to a step of zero.
// The end of the best method is part of every estimate. Where in a step a velocity passes through zero decides on the
// error of time stepping: it holds an accuracy only if it does with the motion begun at four places of the first step.
#pragma once

#include "breakaway/sil/accuracy.hpp"

namespace breakaway::sil {

// Costs are compared by counts of steps and events, so that the choice does not depend on the load of the machine; the
// search itself takes some ten runs of the method that is chosen, and the best end. Requires scenario.accuracy_m. An
// integrator that the file names is kept, and only its step or tolerance is chosen. Throws InputError when the scenario
// has no start, and AccuracyRefused when no method holds.
Accuracy choose_method(const scenario::MachineScenario& scenario);

// All methods at all their steps and tolerances up to what would be refused as too dear: error against cost. The choice
// is the same as above; `asked_m` in it is what scenario.accuracy_m holds.
std::vector<MethodTrial> try_methods(const scenario::MachineScenario& scenario);

}  // namespace breakaway::sil
