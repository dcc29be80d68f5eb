#include "quad_algebra.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace breakaway::campaign {
namespace {

constexpr double dependent = 1e-24;

// Removes what `basis` spans, twice: once is not enough for rounding.
Vector left_of(Vector column, const std::vector<Vector>& basis) {
  for (int pass = 0; pass < 2; ++pass) {
    for (const Vector& b : basis) add_scaled(column, -dot(b, column), b);
  }
  return column;
}

bool extend(std::vector<Vector>& basis, const Vector& column) {
  const Real before = norm(column);
  Vector rest = left_of(column, basis);
  const Real after = norm(rest);
  if (!(after > Real(dependent) * before)) return false;
  rest = left_of(std::move(rest), basis);
  const Real size = norm(rest);
  for (Real& x : rest) x /= size;
  basis.push_back(std::move(rest));
  return true;
}

}  // namespace

Real square_root(Real x) {
  if (!(x > 0)) return 0;
  Real root = std::sqrt(static_cast<long double>(x));
  for (int i = 0; i < 2; ++i) root = (root + x / root) / 2;
  return root;
}

Real dot(const Vector& a, const Vector& b) {
  Real sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

Real norm(const Vector& a) { return square_root(dot(a, a)); }

Real largest(const Vector& a) {
  Real most = 0;
  for (const Real x : a) most = larger(most, magnitude(x));
  return most;
}

void add_scaled(Vector& to, Real factor, const Vector& from) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * from[i];
}

Vector operator-(Vector a) {
  for (Real& x : a) x = -x;
  return a;
}

Matrix Matrix::identity(std::size_t size) {
  Matrix result(size, size);
  for (std::size_t i = 0; i < size; ++i) result(i, i) = 1;
  return result;
}

Vector Matrix::column(std::size_t j) const {
  Vector result(rows_);
  for (std::size_t i = 0; i < rows_; ++i) result[i] = (*this)(i, j);
  return result;
}

Matrix Matrix::transposed() const {
  Matrix result(columns_, rows_);
  for (std::size_t i = 0; i < rows_; ++i) {
    for (std::size_t j = 0; j < columns_; ++j) result(j, i) = (*this)(i, j);
  }
  return result;
}

Real Matrix::row_norm() const {
  Real most = 0;
  for (std::size_t i = 0; i < rows_; ++i) {
    Real sum = 0;
    for (std::size_t j = 0; j < columns_; ++j) sum += magnitude((*this)(i, j));
    most = larger(most, sum);
  }
  return most;
}

Real Matrix::peak() const { return largest(entries_); }

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix result(a.rows(), b.columns());
  for (std::size_t i = 0; i < a.rows(); ++i) {
    for (std::size_t k = 0; k < a.columns(); ++k) {
      const Real factor = a(i, k);
      if (factor == 0) continue;
      for (std::size_t j = 0; j < b.columns(); ++j) result(i, j) += factor * b(k, j);
    }
  }
  return result;
}

Vector operator*(const Matrix& a, const Vector& x) {
  Vector result(a.rows());
  for (std::size_t i = 0; i < a.rows(); ++i) {
    for (std::size_t j = 0; j < a.columns(); ++j) result[i] += a(i, j) * x[j];
  }
  return result;
}

Matrix from_columns(const std::vector<Vector>& columns, std::size_t rows) {
  Matrix result(rows, columns.size());
  for (std::size_t j = 0; j < columns.size(); ++j) {
    for (std::size_t i = 0; i < rows; ++i) result(i, j) = columns[j][i];
  }
  return result;
}

Vector solve(Matrix a, Vector b) {
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

Matrix inverse_cholesky_factor(const Matrix& a) {
  const std::size_t n = a.rows();
  Matrix factor(n, n), inverse(n, n);
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

Split split_space(const std::vector<Vector>& columns, std::size_t dimension) {
  std::vector<Vector> basis;
  for (const Vector& column : columns) {
    if (basis.size() < dimension) extend(basis, column);
  }
  const std::size_t rank = basis.size();
  // Of the unit vectors, those that the basis spans least come first.
  std::vector<std::pair<Real, std::size_t>> order;
  for (std::size_t i = 0; i < dimension; ++i) {
    Real spanned = 0;
    for (const Vector& b : basis) spanned += b[i] * b[i];
    order.emplace_back(spanned, i);
  }
  std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [spanned, i] : order) {
    Vector unit(dimension);
    unit[i] = 1;
    if (basis.size() < dimension) extend(basis, unit);
  }
  const auto middle = basis.begin() + static_cast<std::ptrdiff_t>(rank);
  return {from_columns({basis.begin(), middle}, dimension), from_columns({middle, basis.end()}, dimension)};
}

}  // namespace breakaway::campaign
