#include "breakaway/stability/synthesis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "gain_search.hpp"
#include "infinite.hpp"
#include "scaled_system.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// This is relative. It is needed because E is computed twice, from matrices that may be ill-conditioned.
constexpr double resting_tolerance = 1e-9;

// The wants of every coordinate.
VectorXd unit_of(const PdWants& wants, Index coordinates) {
  return wants.unit.size() > 0 ? wants.unit : VectorXd{VectorXd::Ones(coordinates)};
}

// Positions at rest within this of 0 are inside the level, for |q| = r has at most the energy lambda_max(K) r^2 / 2.
double reach_m(const LinearMachine<>& closed, const VectorXd& unit, double level_J) {
  const MatrixXd stiffness = unit.asDiagonal() * (dense::symmetric_part(closed.stiffness) * unit.asDiagonal());
  return std::sqrt(2 * level_J / dense::symmetric_eigenvalues(stiffness).maxCoeff());
}

Assessment assessed(const LinearMachine<>& closed, const PdWants& wants) {
  const Attractivity a = certify_attractivity(closed);
  const bool region = a.certified && a.all_of_E && a.rho_star_J >= wants.region_J;
  return {region && reach_m(closed, unit_of(wants, closed.coordinates()), a.rho_star_J) >= wants.reach_m, a.rho_star_J};
}

// What the damping of a design has to spare: where it alone brings a motion to rest, the certificate would hold for a
// damping that is nothing but rounding, and the motion would take for ever. It is asked of no more than a direction has
// that no actuator acts on.
class DampingReserve {
 public:
  explicit DampingReserve(const ActuatedSystem& system) {
    const ActuatedSystem scaled = in_mass_units(system).system;
    const MatrixXd pushes = scaled.machine.directions * scaled.machine.friction_N.asDiagonal();
    MatrixXd acting(pushes.rows(), pushes.cols() + scaled.actuators.cols());
    acting << pushes, scaled.actuators;
    unfelt_ = spanned_space(pushes).complement;
    const double asked_per_s = damping_reserve * damping_unit_per_s(scaled.machine);
    const auto share = [&](const MatrixXd& columns) {
      const double own_per_s = least_damping_per_s(scaled.machine, spanned_space(columns).complement);
      return 0.99 * (own_per_s > 0 ? std::min(asked_per_s, own_per_s) : asked_per_s);
    };
    unfelt_per_s_ = share(acting);
    everywhere_per_s_ = share(scaled.actuators);
  }

  // Of the motions that no friction feels.
  bool unfelt_is_damped(const ActuatedSystem& system) const {
    return least_damping_per_s(in_mass_units(system).system.machine, unfelt_) >= unfelt_per_s_;
  }

  // The machine with less damping, of the same rate for every mass. The eigencolumns are those of the machine itself.
  LinearMachine<> taken_from(LinearMachine<> closed) const {
    closed.damping.diagonal() -= everywhere_per_s_ * closed.mass.diagonal();
    return closed;
  }

 private:
  static double least_damping_per_s(const LinearMachine<>& in_mass_units, const MatrixXd& basis) {
    if (basis.cols() == 0) return infinite;
    return dense::symmetric_eigenvalues(dense::symmetric_part(dense::congruence(basis, in_mass_units.damping)))[0];
  }

  MatrixXd unfelt_;  // in mass units, orthonormal
  double unfelt_per_s_, everywhere_per_s_;
};

void require_solvable(const ActuatedSystem& system, const PdWants& wants) {
  require_valid(system.machine);
  const Index n = system.machine.coordinates();
  if (system.actuators.rows() != n || system.actuators.cols() == 0)
    throw InputError{"actuators", "must have a row for each coordinate and a column for each actuator"};
  if (!(wants.resting_error_m > 0)) throw InputError{"the wanted resting error must be above 0 m"};
  if (!(wants.region_J >= 0)) throw InputError{"the wanted region must be 0 J or more"};
  if (!(wants.reach_m >= 0)) throw InputError{"the wanted reach must be 0 m or more"};
  if (wants.unit.size() > 0 && (wants.unit.size() != n || !(wants.unit.array() > 0).all() || !wants.unit.allFinite()))
    throw InputError{"the units of the wants must be above 0, one for each coordinate"};
  if (system.actuators.cwiseAbs().maxCoeff() == 0) throw InputError{"actuators are all 0: give each a direction"};
  for (const Condition& condition : machine_conditions(system)) {
    if (!condition.holds) throw InputError{condition.name + " fails: " + condition.reason};
  }
}

MatrixXd position_gain(const ActuatedSystem& system, const PdWants& wants, GainStructure structure,
                       const SearchProgress& progress) {
  const LinearMachine<>& machine = system.machine;
  const VectorXd unit = unit_of(wants, machine.coordinates());
  const double open_m = resting_error(machine, unit);
  if (std::isfinite(open_m) && open_m <= wants.resting_error_m * (1 + resting_tolerance)) {
    return MatrixXd{MatrixXd::Zero(system.actuators.cols(), machine.mass.rows())};
  }
  if (std::isinf(wants.resting_error_m)) {
    throw InputError{
        "the stiffness is not symmetric and positive definite, so the machine needs gains of position: say how "
        "far from the target it may rest (resting error)"};
  }
  if ((machine.directions * machine.friction_N.asDiagonal()).isZero(0)) {
    throw InputError{"the machine has no friction, so there is no resting error to design for: add its friction"};
  }
  const VectorXd limit_m = wants.resting_error_m * unit;
  return structure == GainStructure::full ? full_position_gain(system, limit_m, wants.resting_error_m, progress)
                                          : identical_position_gain(system, limit_m, wants.resting_error_m, progress);
}

MatrixXd velocity_gain(const ActuatedSystem& system, const PdWants& wants, GainStructure structure,
                       const SearchProgress& progress) {
  const MatrixXd& damping = system.machine.damping;
  const DampingReserve reserve{system};
  if ((symmetric(damping) || structure == GainStructure::identical) && assessed(system.machine, wants).accepted &&
      reserve.unfelt_is_damped(system)) {
    return MatrixXd{MatrixXd::Zero(system.actuators.cols(), damping.rows())};
  }
  const bool everywhere = std::isinf(wants.region_J) || std::isinf(wants.reach_m);
  const Assess assess = [&](const MatrixXd& gain) {
    const LinearMachine<> closed = closed_loop(system, {MatrixXd::Zero(gain.rows(), gain.cols()), gain});
    Assessment found = assessed(closed, wants);
    found.accepted = found.accepted && reserve.unfelt_is_damped({closed, system.actuators}) &&
                     (std::isfinite(found.rho_star_J) || assessed(reserve.taken_from(closed), wants).accepted);
    return found;
  };
  return structure == GainStructure::full ? full_velocity_gain(system, everywhere, assess, progress)
                                          : identical_velocity_gain(system, assess, progress);
}

}  // namespace

double resting_error(const LinearMachine<>& system, const VectorXd& limit_m) {
  if (!symmetric(system.stiffness) || !(system.stiffness.diagonal().array() > 0).all()) return infinite;
  const VectorXd unit = system.stiffness.diagonal().cwiseSqrt().cwiseInverse();
  const dense::Cholesky factors(unit.asDiagonal() * (system.stiffness * unit.asDiagonal()));
  if (!factors.succeeded() || factors.reciprocal_condition() < 1e-14) return infinite;
  const MatrixXd pushes = unit.asDiagonal() * (system.directions * system.friction_N.asDiagonal());
  const VectorXd extent_m = unit.cwiseProduct(factors.solve(pushes).cwiseAbs().rowwise().sum());
  return extent_m.cwiseQuotient(limit_m).maxCoeff();
}

PdDesign synthesize(const ActuatedSystem& system, const PdWants& wants, GainStructure structure,
                    const DesignProgress& progress) {
  constexpr double position_share = 0.2;  // of the work; it takes two programs, the velocity some twenty-five
  require_solvable(system, wants);
  PdDesign design;
  const Index k = system.actuators.cols(), n = system.machine.coordinates();
  design.gains = {position_gain(system, wants, structure, {progress, 0, position_share}), MatrixXd::Zero(k, n)};

  const ActuatedSystem stiffened{closed_loop(system, design.gains), system.actuators};
  design.gains.velocity_Ns_per_m = velocity_gain(stiffened, wants, structure, {progress, position_share, 1});

  const VectorXd unit = unit_of(wants, n);
  design.closed_loop = closed_loop(system, design.gains);
  design.attractivity = certify_attractivity(design.closed_loop);
  design.extent_m = EquilibriumSet::make(design.closed_loop).extent();
  design.reach_m = reach_m(design.closed_loop, unit, design.attractivity.rho_star_J);
  if (!assessed(design.closed_loop, wants).accepted ||
      design.extent_m.cwiseQuotient(unit).maxCoeff() > wants.resting_error_m * (1 + resting_tolerance)) {
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
