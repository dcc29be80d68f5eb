#include "breakaway/stability/synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "gain_search.hpp"
#include "infinite.hpp"

namespace breakaway::stability {
namespace {

using Eigen::MatrixXd;

// Relative: E is computed twice, from matrices that may be ill-conditioned.
constexpr double resting_tolerance = 1e-9;

// Positions at rest within this of 0 are inside the level, for |q| = r has at most the energy lambda_max(K) r^2 / 2.
double reach_m(const LinearMachine<>& closed, double level_J) {
  return std::sqrt(2 * level_J / dense::symmetric_eigenvalues(dense::symmetric_part(closed.stiffness)).maxCoeff());
}

bool meets(const LinearMachine<>& closed, const PdWants& wants) {
  const Attractivity a = certify_attractivity(closed);
  return a.certified && a.all_of_E && a.rho_star_J >= wants.region_J && reach_m(closed, a.rho_star_J) >= wants.reach_m;
}

// Attractive from everywhere even with less damping; the eigencolumns are those of the closed loop itself.
bool attracts_with_reserve(LinearMachine<> closed, double reserve_Ns_per_m) {
  closed.damping.diagonal().array() -= reserve_Ns_per_m;
  return std::isinf(certify_attractivity(closed).rho_star_J);
}

void require_solvable(const ActuatedSystem& system, const PdWants& wants) {
  if (!(wants.resting_error_m > 0)) throw InputError{"the wanted resting error must be above 0 m"};
  if (!(wants.region_J >= 0)) throw InputError{"the wanted region must be 0 J or more"};
  if (!(wants.reach_m >= 0)) throw InputError{"the wanted reach must be 0 m or more"};
  if (system.actuators.cwiseAbs().maxCoeff() == 0) throw InputError{"actuators are all 0: give each a direction"};
  for (const Condition& condition : machine_conditions(system)) {
    if (!condition.holds) throw InputError{condition.name + " fails: " + condition.reason};
  }
}

MatrixXd position_gain(const ActuatedSystem& system, const PdWants& wants, GainStructure structure) {
  const LinearMachine<>& machine = system.machine;
  const double open_m = resting_error_m(machine);
  if (std::isfinite(open_m) && open_m <= wants.resting_error_m * (1 + resting_tolerance)) {
    return MatrixXd{MatrixXd::Zero(system.actuators.cols(), machine.mass.rows())};
  }
  if (std::isinf(wants.resting_error_m)) {
    throw InputError{
        "the stiffness is not symmetric and positive definite, so the machine needs gains of position: say how "
        "far from the target it may rest (resting error)"};
  }
  if ((machine.directions * machine.friction_N).isZero(0)) {
    throw InputError{"the machine has no friction, so there is no resting error to design for: add its friction"};
  }
  return structure == GainStructure::full ? full_position_gain(system, wants.resting_error_m)
                                          : identical_position_gain(system, wants.resting_error_m);
}

MatrixXd velocity_gain(const ActuatedSystem& system, const PdWants& wants, GainStructure structure) {
  const MatrixXd& damping = system.machine.damping;
  if ((symmetric(damping) || structure == GainStructure::identical) && meets(system.machine, wants)) {
    return MatrixXd{MatrixXd::Zero(system.actuators.cols(), damping.rows())};
  }
  const bool everywhere = std::isinf(wants.region_J) || std::isinf(wants.reach_m);
  const Accepts accepts = [&](const LinearMachine<>& closed) {
    return meets(closed, wants) &&
           (!everywhere ||
            attracts_with_reserve(closed, 0.99 * damping_reserve * damping_unit_Ns_per_m(system.machine)));
  };
  return structure == GainStructure::full ? full_velocity_gain(system, everywhere, accepts)
                                          : identical_velocity_gain(system, accepts);
}

}  // namespace

double resting_error_m(const LinearMachine<>& system) {
  if (!symmetric(system.stiffness)) return infinite;
  const dense::Cholesky factors(system.stiffness);
  if (!factors.succeeded() || factors.reciprocal_condition() < 1e-14) return infinite;
  return factors.solve(system.directions * system.friction_N.asDiagonal()).cwiseAbs().rowwise().sum().maxCoeff();
}

PdDesign synthesize(const ActuatedSystem& system, const PdWants& wants, GainStructure structure) {
  require_solvable(system, wants);
  PdDesign design;
  const Eigen::Index k = system.actuators.cols(), n = system.machine.mass.rows();
  design.gains = {position_gain(system, wants, structure), MatrixXd::Zero(k, n)};

  const ActuatedSystem stiffened{closed_loop(system, design.gains), system.actuators};
  design.gains.velocity_Ns_per_m = velocity_gain(stiffened, wants, structure);

  design.closed_loop = closed_loop(system, design.gains);
  design.attractivity = certify_attractivity(design.closed_loop);
  design.extent_m = EquilibriumSet::make(design.closed_loop).extent();
  design.reach_m = reach_m(design.closed_loop, design.attractivity.rho_star_J);
  if (!meets(design.closed_loop, wants) ||
      design.extent_m.maxCoeff() > wants.resting_error_m * (1 + resting_tolerance)) {
    throw InputError{"the gains found do not pass the certificate: " +
                     (design.attractivity.reason.empty()
                          ? "rounding is too coarse for what is wanted; ask for a little less"
                          : design.attractivity.reason)};
  }
  return design;
}

std::vector<GainSweepRow> sweep_velocity_gain(const ActuatedSystem& system, const PdGains& gains,
                                              const std::vector<double>& norms_Ns_per_m) {
  const double norm = dense::spectral_norm(gains.velocity_Ns_per_m);
  std::vector<GainSweepRow> rows;
  for (const double wanted : norms_Ns_per_m) {
    const PdGains scaled{gains.position_N_per_m, gains.velocity_Ns_per_m * (wanted / norm)};
    const Attractivity a = certify_attractivity(closed_loop(system, scaled));
    rows.push_back({wanted, a.rho_star_J, a.certified && a.all_of_E});
  }
  return rows;
}

}  // namespace breakaway::stability
