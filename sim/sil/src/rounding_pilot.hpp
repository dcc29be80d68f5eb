// What rounding makes of the end of a motion.
#pragma once

#include "machine_end.hpp"

namespace breakaway::sil {

// An estimate of the error that rounding leaves in `end`, which the event-driven method gave: the same motion in other
// units of length, time and force is rounded elsewhere, and its ends scatter about the true one. It sees what rounding
// of the data makes as well. Takes three runs.
double rounding_error_m(const scenario::MachineScenario& scenario, const MachineEnd& end);

}  // namespace breakaway::sil
