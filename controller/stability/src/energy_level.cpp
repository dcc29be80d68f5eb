#include "breakaway/stability/energy_level.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "infinite.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using SymmetricEigen = Eigen::SelfAdjointEigenSolver<MatrixXd>;
using GeneralEigen = Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>;

MatrixXd symmetric_part(const MatrixXd& matrix) { return (matrix + matrix.transpose()) / 2; }

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

// With the negative part of C in its own eigenbasis, where that is in span W, as condition 2 demands.
double level_in_eigenbasis_J(const LinearMachine<>& system, const MatrixXd& damping, const SpannedSpace& space,
                             const MatrixXd& corners) {
  const SymmetricEigen eigen(damping);
  const MatrixXd part =
      eigen.eigenvectors() * negative(eigen.eigenvalues()).asDiagonal() * eigen.eigenvectors().transpose();
  if ((part * space.complement).norm() > 1e-9 * part.norm()) return 0;
  return level_J(system.mass.llt().matrixL().solve(part), corners);
}

// With C reduced to the velocities that friction acts on, and its negative part in the basis in which the mass that is
// felt there is diagonal, too.
double level_in_mass_basis_J(const LinearMachine<>& system, const MatrixXd& damping, const SpannedSpace& space,
                             const MatrixXd& corners) {
  const MatrixXd &held = space.basis, &free = space.complement;
  MatrixXd reduced = held.transpose() * damping * held;
  if (free.cols() > 0) {
    const MatrixXd coupling = free.transpose() * damping * held;
    reduced -= coupling.transpose() * (free.transpose() * damping * free).llt().solve(coupling);
  }
  const MatrixXd felt = symmetric_part((held.transpose() * system.mass.llt().solve(held)).inverse());
  const GeneralEigen eigen(symmetric_part(reduced), felt);
  return level_J(
      negative(eigen.eigenvalues()).asDiagonal() * eigen.eigenvectors().transpose() * felt * held.transpose(), corners);
}

}  // namespace

double dissipated_level_J(const LinearMachine<>& system) {
  const MatrixXd pushes = system.directions * system.friction_N.asDiagonal();
  const SpannedSpace space = spanned_space(pushes);
  if (facet_candidates(space) > most_facet_candidates) return 0;
  const MatrixXd damping = symmetric_part(system.damping);
  if (space.complement.cols() > 0) {
    const SymmetricEigen on_free(symmetric_part(space.complement.transpose() * damping * space.complement));
    if (!(on_free.eigenvalues()[0] > 1e-12 * damping.norm())) return 0;
  }
  if (space.basis.cols() == 0) return infinite;
  const MatrixXd corners = unit_corners(space, pushes);
  return std::max(level_in_eigenbasis_J(system, damping, space, corners),
                  level_in_mass_basis_J(system, damping, space, corners));
}

double parting_rate_per_s(const LinearMachine<>& system) {
  const GeneralEigen eigen(symmetric_part(system.damping), system.mass, Eigen::EigenvaluesOnly);
  const double rounding = 1e-13 * eigen.eigenvalues().cwiseAbs().maxCoeff();
  return std::max(0.0, rounding - eigen.eigenvalues()[0]);
}

}  // namespace breakaway::stability
