// Dense linear algebra on numbers of 113 bits, for the reference computation alone. It shares nothing with the
// library's own algebra, so that one mistake cannot sit on both sides of a comparison.
#pragma once

#include <cfloat>
#include <cstddef>
#include <vector>

namespace breakaway::campaign {

#if LDBL_MANT_DIG >= 113
using Real = long double;
#else
using Real = __float128;
#endif

inline Real magnitude(Real x) { return x < 0 ? -x : x; }
inline Real larger(Real a, Real b) { return a < b ? b : a; }
Real square_root(Real x);

using Vector = std::vector<Real>;

Real dot(const Vector& a, const Vector& b);
Real norm(const Vector& a);
Real largest(const Vector& a);                                 // max |a_i|
void add_scaled(Vector& to, Real factor, const Vector& from);  // to += factor from
Vector operator-(Vector a);

// A matrix, row by row.
class Matrix {
 public:
  Matrix() = default;
  Matrix(std::size_t rows, std::size_t columns) : rows_{rows}, columns_{columns}, entries_(rows * columns) {}
  static Matrix identity(std::size_t size);

  std::size_t rows() const { return rows_; }
  std::size_t columns() const { return columns_; }
  Real& operator()(std::size_t i, std::size_t j) { return entries_[i * columns_ + j]; }
  Real operator()(std::size_t i, std::size_t j) const { return entries_[i * columns_ + j]; }
  Vector column(std::size_t j) const;
  Matrix transposed() const;
  Real row_norm() const;  // the largest sum of magnitudes in a row
  Real peak() const;      // the largest magnitude

 private:
  std::size_t rows_ = 0, columns_ = 0;
  Vector entries_;
};

Matrix operator*(const Matrix& a, const Matrix& b);
Vector operator*(const Matrix& a, const Vector& x);
Matrix from_columns(const std::vector<Vector>& columns, std::size_t rows);

// Solves a x = b by elimination with row pivoting. Returns an empty vector for a singular matrix.
Vector solve(Matrix a, Vector b);

// Returns L^-1 with L L^T = a, for a positive definite.
Matrix inverse_cholesky_factor(const Matrix& a);

// Orthonormal columns: `range` spans those of the given columns, `complement` the rest of the space. A column counts as
// dependent when less than 1e-24 of it is left.
struct Split {
  Matrix range, complement;
};
Split split_space(const std::vector<Vector>& columns, std::size_t dimension);

}  // namespace breakaway::campaign
