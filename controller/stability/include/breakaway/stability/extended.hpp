// Dense linear algebra in extended precision, compiled once: factors that are found so and then rounded to double have
// lost nothing on the way. Otherwise as dense.hpp.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>

namespace breakaway::stability::extended {

using Matrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

// A x = lambda x with unit vectors x; complex values come in conjugate pairs, the positive imaginary part first.
struct GeneralEigen {
  bool found;  // else the iteration did not converge, and nothing is known
  Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, 1> values;
  Eigen::Matrix<std::complex<long double>, Eigen::Dynamic, Eigen::Dynamic> vectors;
};

// A must be square.
GeneralEigen general_eigen(const Matrix& a);

// The orthonormal eigenvectors of a symmetric matrix, in the order of ascending values.
Matrix symmetric_eigenvectors(const Matrix& a);

// L^-1 of a symmetric and positive definite matrix A = L L^T.
Matrix inverse_cholesky_factor(const Matrix& a);

// Inverts a matrix whatever the scales of its rows and columns are. One that is singular to rounding has an inverse,
// too.
Matrix inverse(const Matrix& a);

// Returns nothing for a matrix that is singular to rounding.
std::optional<Matrix> inverse_if_regular(const Matrix& a);

// This is dense::Span in extended precision.
struct Span {
  Matrix basis, complement;

  Eigen::Index rank() const { return basis.cols(); }
};

Span span(const Matrix& columns, long double threshold);

}  // namespace breakaway::stability::extended
