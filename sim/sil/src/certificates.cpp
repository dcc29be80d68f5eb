#include "breakaway/sil/certificates.hpp"

#include <Eigen/LU>

#include "breakaway/sil/contradiction.hpp"

namespace breakaway::sil {

Certificates certify(const stability::LinearMachine<>& machine) {
  const Eigen::VectorXd force_N = stability::constant_force(machine);
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
  certificates.attractivity = stability::certify_attractivity(machine);
  certificates.escapes = stability::escape_levels(machine);
  require_consistent(machine, certificates);
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

}  // namespace breakaway::sil
