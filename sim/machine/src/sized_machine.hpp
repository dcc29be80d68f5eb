// A machine whose sizes are known to the compiler, for which simulation is several times faster.
#pragma once

#include "breakaway/plant/linear_machine.hpp"

namespace breakaway::machine {

template <int N, int M>
plant::LinearMachine<N, M> sized(const plant::LinearMachine<>& machine) {
  plant::LinearMachine<N, M> fixed;
  fixed.mass = machine.mass;
  fixed.damping = machine.damping;
  fixed.stiffness = machine.stiffness;
  fixed.directions = machine.directions;
  fixed.friction_N = machine.friction_N;
  return fixed;
}

}  // namespace breakaway::machine
