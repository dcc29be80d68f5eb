#include "breakaway/stability/energy_level.hpp"

#include <algorithm>

#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/mass_units.hpp"
#include "infinite.hpp"
#include "power_proof.hpp"
#include "proved_level.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using dense::Cholesky;
using dense::symmetric_part;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd negative(const VectorXd& values) { return values.cwiseMin(0.0); }

// The negative part of C in its own eigenbasis. It serves where that lies in span W, as condition 2 demands.
MatrixXd part_in_eigenbasis(const LinearMachine<>& system) {
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(symmetric_part(system.damping));
  return eigen.vectors * (-negative(eigen.values)).asDiagonal() * eigen.vectors.transpose();
}

// This reduces C to the velocities that friction acts on, and takes its negative part in the basis in which the mass
// that is felt there is diagonal, too.
MatrixXd part_in_mass_basis(const LinearMachine<>& system, const SpannedSpace& space) {
  const MatrixXd &held = space.basis, &free = space.complement, damping = symmetric_part(system.damping);
  MatrixXd reduced = dense::congruence(held, damping);
  if (free.cols() > 0) {
    const MatrixXd coupling = free.transpose() * damping * held;
    reduced -= coupling.transpose() * (dense::inverse(dense::congruence(free, damping)) * coupling);
  }
  const MatrixXd felt = symmetric_part(dense::inverse(held.transpose() * Cholesky(system.mass).solve(held)));
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(symmetric_part(reduced), felt);
  const MatrixXd roots = held * felt * eigen.vectors;
  return roots * (-negative(eigen.values)).asDiagonal() * roots.transpose();
}

// The forces Y with W Y W^T = X, for an X that is made of directions in span W. Frictions of 0 N have no part in it.
MatrixXd forces_for(const MatrixXd& x, const LinearMachine<>& system) {
  MatrixXd unit = MatrixXd::Zero(system.coordinates(), system.frictions());
  VectorXd inverse_norm = VectorXd::Zero(system.frictions());
  for (Index i = 0; i < system.frictions(); ++i) {
    const double norm = system.directions.col(i).stableNorm();
    if (!(system.friction_N[i] > 0 && norm > 0)) continue;
    inverse_norm[i] = 1 / norm;
    unit.col(i) = system.directions.col(i) / norm;
  }
  const MatrixXd inverse = dense::solution(unit, MatrixXd::Identity(unit.rows(), unit.rows()), 1e-12);
  return inverse_norm.asDiagonal() * symmetric_part(inverse * x * inverse.transpose()) * inverse_norm.asDiagonal();
}

// 1 / (2 kappa^2) with kappa the largest |W Y W^T v|_{M^-1} over h(v) <= 1: a norm is greatest at a corner.
double level_J(const LinearMachine<>& system, const MatrixXd& forces, const MatrixXd& corners) {
  const MatrixXd held = system.directions * forces * (system.directions.transpose() * corners);
  const double kappa = Cholesky(system.mass).solve_lower(held).colwise().norm().maxCoeff();
  return kappa > 0 ? 1 / (2 * kappa * kappa) : 0;
}

}  // namespace

double dissipated_level_J(const LinearMachine<>& machine) { return dissipated_level_J(machine, PowerProof{machine}); }

double dissipated_level_J(const LinearMachine<>& machine, const PowerProof& proof) {
  if (!proof.found()) return 0;
  if (proof.everywhere()) return infinite;
  const LinearMachine<> system = in_units(machine, mass_units(machine.mass));
  const MatrixXd pushes = system.directions * system.friction_N.asDiagonal();
  const SpannedSpace space = spanned_space(pushes);
  double best_J = proof.level_J();
  if (space.basis.cols() == 0 || facet_candidates(space) > most_facet_candidates) return best_J;
  const MatrixXd corners = unit_corners(space, pushes);
  for (const MatrixXd& part : {part_in_eigenbasis(system), part_in_mass_basis(system, space)}) {
    if (!part.allFinite()) continue;
    const MatrixXd forces = proof.completed(forces_for(part, system));
    if (forces.size() > 0) best_J = std::max(best_J, level_J(system, forces, corners));
  }
  return best_J;
}

double parting_rate_per_s(const LinearMachine<>& system) {
  const VectorXd rates = dense::symmetric_eigenvalues(symmetric_part(system.damping), system.mass);
  const double size = static_cast<double>(rates.size());
  const double rounding = rates.cwiseAbs().maxCoeff() * (1e-13 + 1e-15 * size / definiteness(system.mass));
  return std::max(0.0, rounding - rates[0]);
}

}  // namespace breakaway::stability
