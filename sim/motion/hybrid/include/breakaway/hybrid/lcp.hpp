// The linear complementarity problem w = A z + b, w >= 0, z >= 0, w^T z = 0, by Lemke's method. It ends with the
// solution for every A that is copositive-plus, which those of dry friction are (Cottle, Pang & Stone, The Linear
// Complementarity Problem, theorem 4.4.12). There is no absolute tolerance.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace breakaway::hybrid {

// There is room for two unknowns for each of 16 friction directions, and nothing is on the heap.
inline constexpr int most_unknowns = 32;

template <class Scalar>
using LcpMatrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_unknowns, most_unknowns>;
template <class Scalar>
using LcpVector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor, most_unknowns, 1>;

template <class Scalar>
struct LcpSolution {
  LcpVector<Scalar> z;
  // Bit i: z_i is basic, so that w_i is exactly 0; else z_i is. Rounding cannot blur this, as it does w = A z + b.
  std::uint32_t basic;
};

// Returns nothing if the problem has no solution, or none that is found in this precision.
template <class Scalar>
std::optional<LcpSolution<Scalar>> solve_lcp(const LcpMatrix<Scalar>& a, const LcpVector<Scalar>& b);

extern template std::optional<LcpSolution<double>> solve_lcp(const LcpMatrix<double>&, const LcpVector<double>&);
extern template std::optional<LcpSolution<long double>> solve_lcp(const LcpMatrix<long double>&,
                                                                  const LcpVector<long double>&);

}  // namespace breakaway::hybrid
