// The eigencolumns U_c of (9), where repeated eigenvalues leave a choice.
//
// Eigenvalues that are equal to rounding may share any orthonormal basis of their eigenspace, and the smallest alpha,
// and with it rho* of (7), depends on it.
#pragma once

#include <Eigen/Core>

#include "breakaway/stability/definite_proof.hpp"

namespace breakaway::stability {

struct Eigencolumns {
  Eigen::MatrixXd columns;
  Eigen::VectorXd values;  // ascending; of a repeated one all are the least
};

// `damping` must be symmetric. What is 0 to rounding is what has been proved of the damping: above 0 where it is
// `definite`, 0 where it is `semidefinite`, and otherwise as far below 0 as rounding may have hidden.
Eigencolumns eigencolumns(const Eigen::MatrixXd& damping, Proof definite, Proof semidefinite);

// Turns the first `unstable` columns within equal eigenvalues, two at a time, for the largest rho*: the smallest
// alpha * max |lambda_i| |M^-1/2 U_i|. `corners` as from unit_corners(). Every basis is valid; this one is the better
// of two local optima that are sought from bases which the machine itself tells, whatever its units.
void turn_for_level(Eigencolumns& basis, Eigen::Index unstable, const Eigen::MatrixXd& inverse_mass,
                    const Eigen::MatrixXd& corners);

}  // namespace breakaway::stability
