// Random linear machines with dry friction, seeded.
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <random>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

inline Eigen::MatrixXd random_matrix(std::mt19937_64& random, Eigen::Index rows, Eigen::Index columns) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

inline Eigen::MatrixXd random_definite(std::mt19937_64& random, Eigen::Index n) {
  const Eigen::MatrixXd root = random_matrix(random, n, n);
  return root * root.transpose() + 0.3 * Eigen::MatrixXd::Identity(n, n);
}

// An orthonormal basis, whose first columns span what the columns of `directions` span.
inline Eigen::MatrixXd basis_along(const Eigen::MatrixXd& directions) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(directions).householderQ() *
         Eigen::MatrixXd::Identity(directions.rows(), directions.rows());
}

// Damping with eigencolumns U and given eigenvalues.
inline Eigen::MatrixXd with_eigenvalues(const Eigen::MatrixXd& columns, const Eigen::VectorXd& values) {
  const Eigen::MatrixXd damping = columns * values.asDiagonal() * columns.transpose();
  return (damping + damping.transpose()) / 2;
}

// The lengths in which each coordinate alone has the mass 1, in which condition 2 of Theorem 1 is asked.
inline Eigen::VectorXd units_of(const LinearMachine<>& s) { return s.mass.diagonal().cwiseSqrt(); }

// A symmetric matrix of these units, written in the machine's own; exactly symmetric.
inline Eigen::MatrixXd from_mass_units(const LinearMachine<>& s, const Eigen::MatrixXd& matrix) {
  return matrix.cwiseProduct(units_of(s) * units_of(s).transpose());
}

// basis_along() the machine's directions, in these units.
inline Eigen::MatrixXd basis_along_directions(const LinearMachine<>& s) {
  return basis_along(units_of(s).cwiseInverse().asDiagonal() * s.directions);
}

// Condition 2 holds: the damping is negative along `unstable` <= min(n, m) directions of span{W} at most, sometimes 0
// or equally negative along several.
inline LinearMachine<> random_theorem_1_system(std::mt19937_64& random, Eigen::Index n, Eigen::Index m) {
  LinearMachine<> s;
  s.mass = random_definite(random, n);
  s.stiffness = random_definite(random, n);
  s.directions = random_matrix(random, n, m);
  s.friction_N = random_matrix(random, m, 1).cwiseAbs() + Eigen::VectorXd::Constant(m, 0.05);
  std::uniform_int_distribution<Eigen::Index> how_many{0, std::min(n, m)};
  std::uniform_int_distribution<int> kind{0, 3};
  Eigen::VectorXd values = random_matrix(random, n, 1).cwiseAbs() + Eigen::VectorXd::Constant(n, 0.05);
  const Eigen::Index unstable = how_many(random);
  values.head(unstable) *= -0.5;
  switch (kind(random)) {
    case 0:
      values.head(unstable).setConstant(-0.2);
      break;
    case 1:
      if (unstable > 0) values[0] = 0;
      break;
    default:
      break;
  }
  s.damping = from_mass_units(s, with_eigenvalues(basis_along_directions(s), values));
  return s;
}

// Only the weaker condition holds: the damping is positive where no friction acts, and has a skew part.
inline LinearMachine<> random_weak_system(std::mt19937_64& random, Eigen::Index n, Eigen::Index m) {
  LinearMachine<> s = random_theorem_1_system(random, n, m);
  const Eigen::MatrixXd skew = random_matrix(random, n, n), fed = s.directions * random_matrix(random, m, m);
  s.damping = random_definite(random, n) - 0.5 * fed * fed.transpose() + 0.3 * (skew - skew.transpose());
  return s;
}

}  // namespace breakaway::stability
