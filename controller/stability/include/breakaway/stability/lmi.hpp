// Linear matrix inequalities, solved by the program SDPA (Debian package sdpa) and checked without it.
//
// A solver of semidefinite programs stops when its own residuals are small: that is no proof. So whoever calls
// minimised() checks what it returns, by proven_least_eigenvalue() or by the property that is wanted in the end.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::stability {

// constant + sum_k x_k matrix_k >= 0 (positive semidefinite), all symmetric and of one size; a variable that is not
// among the terms has no part in it.
struct MatrixInequality {
  Eigen::MatrixXd constant;
  std::vector<std::pair<Eigen::Index, Eigen::MatrixXd>> terms;
};

// minimise cost . x subject to all of `matrices` and to rows * x + offsets >= 0.
struct LmiProblem {
  Eigen::VectorXd cost;  // one entry a variable
  std::vector<MatrixInequality> matrices;
  Eigen::MatrixXd rows;     // inequalities x variables; may have no rows
  Eigen::VectorXd offsets;  // one entry a row
};

// The minimiser to about seven digits, for a problem of numbers around one. The error names the program to install when
// it is absent, or says what the solver found: no solution, or none in its reach.
Eigen::VectorXd minimised(const LmiProblem& problem);

// A lower bound of the least eigenvalue of a symmetric matrix that no rounding can make wrong: Cholesky's method run to
// its end proves it. It lies below the eigenvalue by some 1e-14 of the matrix's size.
double proven_least_eigenvalue(const Eigen::MatrixXd& symmetric);

}  // namespace breakaway::stability
