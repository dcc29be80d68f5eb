#include "dense_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::campaign {
namespace {

// Removes what `basis` spans, twice: once is not enough for rounding.
template <class Real>
Vector<Real> left_of(Vector<Real> column, const std::vector<Vector<Real>>& basis) {
  for (int pass = 0; pass < 2; ++pass) {
    for (const Vector<Real>& b : basis) add_scaled(column, -dot(b, column), b);
  }
  return column;
}

template <class Real>
bool extend(std::vector<Vector<Real>>& basis, const Vector<Real>& column) {
  const Real before = norm(column);
  Vector<Real> rest = left_of(column, basis);
  const Real after = norm(rest);
  if (!(after > Real(10 * Rounding<Real>::noise) * before)) return false;
  rest = left_of(std::move(rest), basis);
  const Real size = norm(rest);
  for (Real& x : rest) x /= size;
  basis.push_back(std::move(rest));
  return true;
}

}  // namespace

template <class Real>
Matrix<Real> Matrix<Real>::identity(std::size_t size) {
  Matrix<Real> result(size, size);
  for (std::size_t i = 0; i < size; ++i) result(i, i) = 1;
  return result;
}

template <class Real>
Vector<Real> Matrix<Real>::column(std::size_t j) const {
  Vector<Real> result(rows_);
  for (std::size_t i = 0; i < rows_; ++i) result[i] = (*this)(i, j);
  return result;
}

template <class Real>
Vector<Real> Matrix<Real>::row(std::size_t i) const {
  const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(i * columns_);
  return {begin, begin + static_cast<std::ptrdiff_t>(columns_)};
}

template <class Real>
Matrix<Real> Matrix<Real>::transposed() const {
  Matrix<Real> result(columns_, rows_);
  for (std::size_t i = 0; i < rows_; ++i) {
    for (std::size_t j = 0; j < columns_; ++j) result(j, i) = (*this)(i, j);
  }
  return result;
}

template <class Real>
Real Matrix<Real>::row_norm() const {
  Real most = 0;
  for (std::size_t i = 0; i < rows_; ++i) {
    Real sum = 0;
    for (std::size_t j = 0; j < columns_; ++j) sum += magnitude((*this)(i, j));
    most = larger(most, sum);
  }
  return most;
}

template <class Real>
Matrix<Real> operator*(const Matrix<Real>& a, const Matrix<Real>& b) {
  Matrix<Real> result(a.rows(), b.columns());
  for (std::size_t i = 0; i < a.rows(); ++i) {
    for (std::size_t k = 0; k < a.columns(); ++k) {
      const Real factor = a(i, k);
      if (factor == 0) continue;
      for (std::size_t j = 0; j < b.columns(); ++j) result(i, j) += factor * b(k, j);
    }
  }
  return result;
}

template <class Real>
Matrix<Real> from_columns(const std::vector<Vector<Real>>& columns, std::size_t rows) {
  Matrix<Real> result(rows, columns.size());
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (std::size_t i = 0; i < rows; ++i) result(i, j) = columns[j][i];
  }
  return result;
}

template <class Real>
Vector<Real> solve(Matrix<Real> a, Vector<Real> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (magnitude(a(i, k)) > magnitude(a(best, k))) best = i;
    }
    if (a(best, k) == 0) return {};
    for (std::size_t j = k; best != k && j < n; ++j) std::swap(a(k, j), a(best, j));
    std::swap(b[k], b[best]);
    for (std::size_t i = k + 1; i < n; ++i) {
      const Real factor = a(i, k) / a(k, k);
      if (factor == 0) continue;
      for (std::size_t j = k; j < n; ++j) a(i, j) -= factor * a(k, j);
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) b[k] -= a(k, j) * b[j];
    b[k] /= a(k, k);
  }
  return b;
}

template <class Real>
Matrix<Real> inverse_cholesky_factor(const Matrix<Real>& a) {
  const std::size_t n = a.rows();
  Matrix<Real> factor(n, n), inverse(n, n);
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      Real sum = a(i, j);
      for (std::size_t k = 0; k < j; ++k) sum -= factor(i, k) * factor(j, k);
      factor(i, j) = i == j ? square_root(sum) : sum / factor(j, j);
    }
  }
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t i = j; i < n; ++i) {
      Real sum = i == j ? 1 : 0;
      for (std::size_t k = j; k < i; ++k) sum -= factor(i, k) * inverse(k, j);
      inverse(i, j) = sum / factor(i, i);
    }
  }
  return inverse;
}

template <class Real>
Split<Real> split_space(const std::vector<Vector<Real>>& columns, std::size_t dimension) {
  std::vector<Vector<Real>> basis;
  for (const Vector<Real>& column : columns) {
    if (basis.size() < dimension) extend(basis, column);
  }
  const std::size_t rank = basis.size();
  // Of the unit vectors, those that the basis spans least come first.
  std::vector<std::pair<Real, std::size_t>> order;
  for (std::size_t i = 0; i < dimension; ++i) {
    Real spanned = 0;
    for (const Vector<Real>& b : basis) spanned += b[i] * b[i];
    order.emplace_back(spanned, i);
  }
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [spanned, i] : order) {
    Vector<Real> unit(dimension);
    unit[i] = 1;
    if (basis.size() < dimension) extend(basis, unit);
  }
  const auto middle = basis.begin() + static_cast<std::ptrdiff_t>(rank);
  const std::vector<Vector<Real>> within{basis.begin(), middle}, beside{middle, basis.end()};
  return {from_columns(within, dimension), from_columns(beside, dimension)};
}

template class Matrix<Fast>;
template Matrix<Fast> operator*(const Matrix<Fast>&, const Matrix<Fast>&);
template Matrix<Fast> from_columns(const std::vector<Vector<Fast>>&, std::size_t);
template Vector<Fast> solve(Matrix<Fast>, Vector<Fast>);
template Matrix<Fast> inverse_cholesky_factor(const Matrix<Fast>&);
template Split<Fast> split_space(const std::vector<Vector<Fast>>&, std::size_t);

template class Matrix<Quad>;
template Matrix<Quad> operator*(const Matrix<Quad>&, const Matrix<Quad>&);
template Matrix<Quad> from_columns(const std::vector<Vector<Quad>>&, std::size_t);
template Vector<Quad> solve(Matrix<Quad>, Vector<Quad>);
template Matrix<Quad> inverse_cholesky_factor(const Matrix<Quad>&);
template Split<Quad> split_space(const std::vector<Vector<Quad>>&, std::size_t);

}  // namespace breakaway::campaign
