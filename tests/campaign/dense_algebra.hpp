// Dense linear algebra for the reference computation alone, on either of its number types. It shares nothing with the
// library's own algebra, so that one mistake cannot sit on both sides of a comparison.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "number_types.hpp"

namespace breakaway::campaign {

template <class Real>
Real magnitude(Real x) {
  return x < 0 ? -x : x;
}

template <class Real>
Real larger(Real a, std::type_identity_t<Real> b) {
  return a < b ? b : a;
}

template <class Real>
Real square_root(Real x) {
  if (!(x > 0)) return 0;
  Real root = std::sqrt(static_cast<long double>(x));
  for (int i = 0; i < 2 && !std::is_same_v<Real, Fast>; ++i) root = (root + x / root) / 2;
  return root;
}

template <class Real>
using Vector = std::vector<Real>;

template <class Real>
Real dot(const Vector<Real>& a, const Vector<Real>& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

template <class Real>
Real norm(const Vector<Real>& a) {
  return square_root(dot(a, a));
}

// The largest magnitude.
template <class Real>
Real largest(const Vector<Real>& a) {
  Real most = 0;
  for (const Real x : a) most = larger(most, magnitude(x));
  return most;
}

// to += factor from
template <class Real>
void add_scaled(Vector<Real>& to, std::type_identity_t<Real> factor, const Vector<Real>& from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

template <class Real>
Vector<Real> operator-(Vector<Real> a) {
  for (Real& x : a) x = -x;
  return a;
}

// A matrix, row by row.
template <class Real>
class Matrix {
 public:
  Matrix() = default;
  Matrix(std::size_t rows, std::size_t columns) : rows_{rows}, columns_{columns}, entries_(rows * columns) {}
  static Matrix identity(std::size_t size);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  Real& operator()(std::size_t i, std::size_t j) { return entries_[i * columns_ + j]; }
  Real operator()(std::size_t i, std::size_t j) const { return entries_[i * columns_ + j]; }
  Vector<Real> column(std::size_t j) const;
  Vector<Real> row(std::size_t i) const;
  Matrix transposed() const;
  Real row_norm() const;  // the largest sum of magnitudes in a row
  Real peak() const { return largest(entries_); }

 private:
  std::size_t rows_ = 0, columns_ = 0;
  Vector<Real> entries_;
};

template <class Real>
Matrix<Real> operator*(const Matrix<Real>& a, const Matrix<Real>& b);

template <class Real>
Vector<Real> operator*(const Matrix<Real>& a, const Vector<Real>& x) {
  Vector<Real> result(a.rows());
  for (std::size_t i = 0; i < a.rows(); ++i) {
    Real sum = 0;
    for (std::size_t j = 0; j < a.columns(); ++j) sum += a(i, j) * x[j];
    result[i] = sum;
  }
  return result;
}

template <class Real>
Matrix<Real> from_columns(const std::vector<Vector<Real>>& columns, std::size_t rows);

// Solves a x = b by elimination with row pivoting. Returns an empty vector for a singular matrix.
template <class Real>
Vector<Real> solve(Matrix<Real> a, Vector<Real> b);

// Returns L^-1 with L L^T = a, for a positive definite.
template <class Real>
Matrix<Real> inverse_cholesky_factor(const Matrix<Real>& a);

// Orthonormal columns: `range` spans those of the given columns, `complement` the rest of the space. A column counts as
// dependent when less than ten times what counts as rounding is left of it.
template <class Real>
struct Split {
  Matrix<Real> range, complement;
};
template <class Real>
Split<Real> split_space(const std::vector<Vector<Real>>& columns, std::size_t dimension);

}  // namespace breakaway::campaign
