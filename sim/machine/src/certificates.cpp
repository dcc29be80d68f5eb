#include "breakaway/machine/certificates.hpp"

namespace breakaway::machine {

design::LinearSystem linear_system(const plant::LinearMachine<>& machine) {
  return {machine.mass, machine.damping, machine.stiffness, machine.directions, machine.friction_N};
}

Certificates certify(const plant::LinearMachine<>& machine) {
  const design::LinearSystem system = linear_system(machine);
  return {design::certify_attractivity(system), design::escape_levels(system)};
}

}  // namespace breakaway::machine
