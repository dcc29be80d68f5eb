#include "breakaway/stability/energy_level.hpp"

#include <algorithm>

#include "breakaway/stability/dense.hpp"
#include "infinite.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using dense::Cholesky;
using dense::symmetric_part;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Those below zero, without what rounding may have made negative.
VectorXd negative(const VectorXd& values) {
  const double zero = 1e-15 * static_cast<double>(values.size()) * values.cwiseAbs().maxCoeff();
  return (values.array() < -zero).select(values, 0);
}

// 1 / (2 kappa^2) with kappa the largest |roots v| over h(v) <= 1: a norm is greatest at a corner.
double level_J(const MatrixXd& roots, const MatrixXd& corners) {
  const double kappa = (roots * corners).colwise().norm().maxCoeff();
  return kappa == 0 ? infinite : 1 / (2 * kappa * kappa);
}

// This takes the negative part of C in its own eigenbasis. It serves where that lies in span W, as condition 2 demands.
double level_in_eigenbasis_J(const LinearMachine<>& system, const MatrixXd& damping, const SpannedSpace& space,
                             const MatrixXd& corners) {
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(damping);
  const MatrixXd part = eigen.vectors * negative(eigen.values).asDiagonal() * eigen.vectors.transpose();
  if ((part * space.complement).norm() > 1e-9 * part.norm()) return 0;
  return level_J(Cholesky(system.mass).solve_lower(part), corners);
}

// This reduces C to the velocities that friction acts on, and takes its negative part in the basis in which the mass
// that is felt there is diagonal, too.
double level_in_mass_basis_J(const LinearMachine<>& system, const MatrixXd& damping, const SpannedSpace& space,
                             const MatrixXd& corners) {
  const MatrixXd &held = space.basis, &free = space.complement;
  MatrixXd reduced = dense::congruence(held, damping);
  if (free.cols() > 0) {
    const MatrixXd coupling = free.transpose() * damping * held;
    reduced -= coupling.transpose() * Cholesky(dense::congruence(free, damping)).solve(coupling);
  }
  const MatrixXd felt = symmetric_part(dense::inverse(held.transpose() * Cholesky(system.mass).solve(held)));
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(symmetric_part(reduced), felt);
  return level_J(negative(eigen.values).asDiagonal() * eigen.vectors.transpose() * felt * held.transpose(), corners);
}

}  // namespace

double dissipated_level_J(const LinearMachine<>& system) {
  const MatrixXd pushes = system.directions * system.friction_N.asDiagonal();
  const SpannedSpace space = spanned_space(pushes);
  if (facet_candidates(space) > most_facet_candidates) return 0;
  const MatrixXd damping = symmetric_part(system.damping);
  if (space.complement.cols() > 0) {
    const MatrixXd on_free = symmetric_part(dense::congruence(space.complement, damping));
    if (!(dense::symmetric_eigenvalues(on_free)[0] > 1e-12 * damping.norm())) return 0;
  }
  if (space.basis.cols() == 0) return infinite;
  const MatrixXd corners = unit_corners(space, pushes);
  return std::max(level_in_eigenbasis_J(system, damping, space, corners),
                  level_in_mass_basis_J(system, damping, space, corners));
}

double parting_rate_per_s(const LinearMachine<>& system) {
  const VectorXd rates = dense::symmetric_eigenvalues(symmetric_part(system.damping), system.mass);
  const double rounding = 1e-13 * rates.cwiseAbs().maxCoeff();
  return std::max(0.0, rounding - rates[0]);
}

}  // namespace breakaway::stability
