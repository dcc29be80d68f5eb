// The cheapest way to follow the axes of a scenario to the accuracy asked for.
//
// Between the events of an axis its motion is a closed form where friction is constant, and otherwise integrated with a
// tolerance, which is what an accuracy chooses. Control law, drive and bus are the same in each run. Its readings are
// counts, so that a difference far below a count may still move a later kick: the error is therefore looked for on the
// whole way, at every period of the loop, or under the ideal law at every kick and at the end.
#pragma once

#include <vector>

#include "breakaway/scenario/scenario.hpp"
#include "breakaway/sil/accuracy.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

// Of an axis, the positions at which two runs are compared.
std::vector<double> compared_positions_m(const AxisResult& axis, bool ideal);

// The largest difference of a compared position, of any axis. A run that ended before the other stays where it was;
// kicks that only one of them has are left out.
double distance_m(const Result& a, const Result& b, bool ideal);

// Each tolerance is tried on the scenario itself and judged by a run at the finest one, whose own error is judged by
// tolerances near it and by starts a rounding away. Requires scenario.run->accuracy_m. Throws InputError as
// run_scenario does, and AccuracyRefused when no tolerance holds.
Accuracy choose_method(const scenario::Scenario& scenario);

// All tolerances, whatever is asked for.
std::vector<MethodTrial> try_methods(const scenario::Scenario& scenario);

// The scenario with this method in place of its own.
scenario::Scenario with_method(scenario::Scenario scenario, const Method& method);

}  // namespace breakaway::sil
