// A motion from inside a certified level, judged by its energy.
#pragma once

#include <string>

#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/linear_machine.hpp"
#include "wild_machines.hpp"

namespace breakaway::campaign {

enum class End { at_rest, on_its_way, refused, grew };

// From 0.9 of the level, or from far away. A machine of weak damping would take for ever: after so many events it is
// judged by its energy alone, which must not have grown at any of them. `said` is what happened, where it grew or was
// refused.
End followed(const stability::LinearMachine<>& machine, const stability::Attractivity& a, WildMachines& random,
             std::string& said, int most_events = 2000);

}  // namespace breakaway::campaign
