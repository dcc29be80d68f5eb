// The linear complementarity problem w = A z + b, w >= 0, z >= 0, w^T z = 0, by Lemke's method. It ends with the
// solution for every A that is copositive-plus, which those of dry friction are (Cottle, Pang & Stone, The Linear
// Complementarity Problem, theorem 4.4.12). There is no absolute tolerance.
#pragma once

#include <Eigen/Core>
#include <optional>

namespace breakaway::hybrid {

// There is room for two unknowns for each of 16 friction directions, and nothing is on the heap.
inline constexpr int most_unknowns = 32;
using LcpMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_unknowns, most_unknowns>;
using LcpVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most_unknowns, 1>;

// Returns z, or nothing if the problem has no solution.
std::optional<LcpVector> solve_lcp(const LcpMatrix& a, const LcpVector& b);

}  // namespace breakaway::hybrid
