// dissipated_level_J() for whoever holds the proof already.
#pragma once

#include "breakaway/stability/linear_machine.hpp"
#include "power_proof.hpp"

namespace breakaway::stability {

double dissipated_level_J(const LinearMachine<>& machine, const PowerProof& proof);

}  // namespace breakaway::stability
