// Dense linear algebra in the 31 digits of DoubleDouble, compiled once: factors that are found so and then rounded to
// double have lost nothing on the way, even where masses or springs differ by 1e12. Otherwise as dense.hpp.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "breakaway/stability/double_double.hpp"

namespace breakaway::stability::twofold {

using Scalar = DoubleDouble;
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

// A = vectors form vectors^T with orthonormal vectors. `form` is upper triangular but for blocks of two on its
// diagonal, which hold complex eigenvalues.
struct RealSchur {
  bool found;  // else the iteration did not converge, and nothing is known
  Matrix form, vectors;
};

// A must be square.
RealSchur real_schur(const Matrix& a);

// The orthonormal eigenvectors of a symmetric matrix, in the order of ascending values.
Matrix symmetric_eigenvectors(const Matrix& a);

// L^-1 of a symmetric and positive definite matrix A = L L^T.
Matrix inverse_cholesky_factor(const Matrix& a);

// Inverts a matrix whatever the scales of its rows and columns are. One that is singular to rounding has an inverse,
// too.
Matrix inverse(const Matrix& a);

// Returns nothing for a matrix that is singular to rounding.
std::optional<Matrix> inverse_if_regular(const Matrix& a);

// Orthonormal columns that span what the first 1, 2, ... given columns do; there are no more of them than rows.
Matrix orthonormalised(const Matrix& columns);

// This is dense::Span in extended precision.
struct Span {
  Matrix basis, complement;

  Eigen::Index rank() const { return basis.cols(); }
};

Span span(const Matrix& columns, double threshold);

}  // namespace breakaway::stability::twofold
