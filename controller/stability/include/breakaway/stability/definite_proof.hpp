// Is a matrix positive definite? A computed eigenvalue cannot say so next to zero: its rounding is that of the largest
// one. Here the answer is proved for the numbers as they are stored, or said to be unknown.
//
// What is examined is x^T A x, so A counts by its symmetric part. Rows and columns are first scaled by powers of two to
// a diagonal of about one. That is exact and changes neither answer, so no unit of length, mass or force decides. Then
//   holds: Cholesky's method, run in extended precision on A less a bound of all its rounding, comes to its end
//     (Rump, Verification of positive definiteness, BIT 46, 2006);
//   fails: a vector x was found with x^T A x below its rounding.
// A semidefinite matrix that is exactly singular is proved by its rank, which is counted modulo so many primes that
// nothing is left open: with r pivots that are proved definite and the rank r, nothing negative is left.
#pragma once

#include <Eigen/Core>

#include "breakaway/stability/extended.hpp"

namespace breakaway::stability {

enum class Proof { holds, fails, unknown };

// x^T A x > 0 for all x != 0. A is square; an empty one is definite. Entries that are not finite give `unknown`.
Proof positive_definite(const Eigen::MatrixXd& a);

// The same of every matrix whose entries differ from those of `a` by at most those of `error` >= 0. `fails` says that
// it fails for all of them.
Proof positive_definite(const extended::Matrix& a, const extended::Matrix& error);

// x^T A x >= 0 for all x.
Proof positive_semidefinite(const Eigen::MatrixXd& a);

}  // namespace breakaway::stability
