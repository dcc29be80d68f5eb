// LinearSystem: a linear mechanical system with dry friction as the certificates see it, (1) and (2) of [A]:
//   M q'' + C q' + K q = W lambda,   lambda_i in -p_i Sign(g_i),   g = W^T q'.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>
#include <optional>

#include "breakaway/design/expected.hpp"

namespace breakaway::design {

struct LinearSystem {
  Eigen::MatrixXd mass;        // M: n x n, symmetric and positive definite
  Eigen::MatrixXd damping;     // C: n x n
  Eigen::MatrixXd stiffness;   // K: n x n
  Eigen::MatrixXd directions;  // W: n x m, dependent columns allowed
  Eigen::VectorXd friction_N;  // p: m, >= 0
};

// What is wrong with K, W and p, which make the equilibrium set: sizes, entries that are no numbers, negative friction.
std::optional<Error> statics_error(const LinearSystem& system);

// The same for all matrices, and whether M and K are symmetric. Whether they are positive definite is condition 1 of
// Theorem 1.
std::optional<Error> system_error(const LinearSystem& system);

// To rounding: 1e-12 of the largest entry, as a closed loop K + S F may have entries far larger than their sum.
bool symmetric(const Eigen::MatrixXd& matrix);

}  // namespace breakaway::design
