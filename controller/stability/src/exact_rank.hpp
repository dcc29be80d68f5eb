// The rank of a matrix of floating-point numbers without any rounding.
#pragma once

#include <Eigen/Core>

namespace breakaway::stability {

// Says whether A + A^T has a rank of `rank` or less. Every minor of `rank` + 1 rows is an integer in units of the last
// bit of the least entry. One that is 0 modulo primes whose product exceeds its size is 0.
bool rank_of_symmetric_part_at_most(const Eigen::MatrixXd& a, Eigen::Index rank);

}  // namespace breakaway::stability
