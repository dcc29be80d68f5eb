#include "breakaway/machine/certificates.hpp"

#include <Eigen/LU>

namespace breakaway::machine {

design::LinearSystem linear_system(const plant::LinearMachine<>& machine) {
  return {machine.mass, machine.damping, machine.stiffness, machine.directions, machine.friction_N};
}

Certificates certify(const plant::LinearMachine<>& machine) {
  const design::LinearSystem system = linear_system(machine);
  const Eigen::VectorXd force_N = plant::constant_force(machine);
  Certificates certificates;
  certificates.centre = Eigen::VectorXd::Zero(machine.coordinates());
  if (!force_N.isZero(0)) {
    const Eigen::FullPivLU<Eigen::MatrixXd> stiffness(machine.stiffness);
    if (!stiffness.isInvertible()) {
      certificates.attractivity.reason =
          "stiffness is singular, so that a constant force may push the machine for ever";
      return certificates;
    }
    certificates.centre = stiffness.solve(force_N);
  }
  certificates.attractivity = design::certify_attractivity(system);
  certificates.escapes = design::escape_levels(system);
  return certificates;
}

Certificates certify(const scenario::MachineScenario& scenario) {
  Certificates certificates = certify(scenario.machine);
  if (scenario.laws.empty()) return certificates;
  auto strongest = scenario.machine;
  for (Eigen::Index i = 0; i < strongest.frictions(); ++i) {
    strongest.friction_N[i] = scenario.laws[static_cast<std::size_t>(i)].bounds().upper_N;
  }
  certificates.escapes = certify(strongest).escapes;
  return certificates;
}

}  // namespace breakaway::machine
