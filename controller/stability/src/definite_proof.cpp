#include "breakaway/stability/definite_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "exact_rank.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using extended::Matrix;
using extended::Vector;

constexpr long double extended_epsilon =
    std::numeric_limits<long double>::epsilon();  // twice the rounding of one operation

// A symmetric matrix and how far its entries may be off.
struct Enclosure {
  Matrix middle, error;
};

Enclosure symmetric_enclosure(const Matrix& a, const Matrix& error) {
  const Matrix middle = (a + a.transpose()) / 2;
  const Matrix rounding = extended_epsilon * (a.cwiseAbs() + a.transpose().cwiseAbs());
  return {middle, (error + error.transpose()) / 2 + rounding};
}

// Scales by powers of two, rows with columns and then all of it, to diagonal entries about one; there must be some, all
// positive. The first of them is from 1 to 2, so that a factor of all entries changes no digit of what follows.
Enclosure equilibrated(Enclosure a) {
  const int first = std::ilogb(a.middle(0, 0));
  for (Index i = 0; i < a.middle.rows(); ++i) {
    const int exponent = -static_cast<int>(std::floor((std::ilogb(a.middle(i, i)) - first) / 2.0));
    for (Matrix* const part : {&a.middle, &a.error}) {
      for (long double& entry : part->row(i)) entry = std::ldexp(entry, exponent);
      for (long double& entry : part->col(i)) entry = std::ldexp(entry, exponent);
    }
  }
  for (Matrix* const part : {&a.middle, &a.error}) {
    for (long double& entry : part->reshaped()) entry = std::ldexp(entry, -first);
  }
  return a;
}

// L of A = L L^T as far as Cholesky's method gets: `done` columns, all of them just when A is definite to rounding.
struct Factor {
  Matrix lower;
  Index done;
};

Factor factorised(const Matrix& a) {
  const Index n = a.rows();
  Factor factor{Matrix::Zero(n, n), 0};
  Matrix& l = factor.lower;
  for (Index& j = factor.done; j < n; ++j) {
    const long double pivot = a(j, j) - l.row(j).head(j).squaredNorm();
    if (!(pivot > 0)) break;
    l(j, j) = std::sqrt(pivot);
    for (Index i = j + 1; i < n; ++i) l(i, j) = (a(i, j) - l.row(i).head(j).dot(l.row(j).head(j))) / l(j, j);
  }
  return factor;
}

// Rump: A is definite when Cholesky's method comes to its end on A - c 1 with c above its backward error, which is less
// than (n + 2) epsilon trace(A). What the entries may be off, and the rounding of the shift, are part of c.
bool proved_definite(const Enclosure& a) {
  const Index n = a.middle.rows();
  const long double rounding = static_cast<long double>(n + 4) * extended_epsilon * a.middle.trace();
  const long double off = a.error.rowwise().sum().maxCoeff();
  if (!std::isfinite(off)) return false;
  const Matrix shifted = a.middle - (2 * rounding + 1.01L * off) * Matrix::Identity(n, n);
  return factorised(shifted).done == n;
}

// The direction in which the part of A that Cholesky's method has got to is least: (-A_11^-1 a_12, 1, 0). It has taken
// one column at least, for the diagonal of A is positive.
Vector falling_direction(const Matrix& a, const Factor& factor) {
  const Index k = factor.done;
  Vector head = -factor.lower.row(k).head(k).transpose();
  factor.lower.topLeftCorner(k, k).transpose().triangularView<Eigen::Upper>().solveInPlace(head);
  Vector x = Vector::Zero(a.rows());
  x[k] = 1;
  x.head(k) = head;
  return x;
}

long double quadratic_form(const Matrix& a, const Vector& x) {
  long double sum = 0;
  for (Index j = 0; j < x.size(); ++j) {
    for (Index i = 0; i < x.size(); ++i) sum += x[i] * a(i, j) * x[j];
  }
  return sum;
}

// x^T A x <= 0, or < 0, whatever the rounding and within what the entries may be off.
bool proved_indefinite(const Enclosure& a, bool strictly) {
  const Factor factor = factorised(a.middle);
  if (factor.done == a.middle.rows()) return false;
  const Vector x = falling_direction(a.middle, factor), size = x.cwiseAbs();
  const long double terms = static_cast<long double>(x.size() * x.size() + 2 * x.size() + 4);
  const long double value = quadratic_form(a.middle, x);
  const long double rounding = terms * extended_epsilon * quadratic_form(a.middle.cwiseAbs(), size);
  const long double most = value + rounding + 1.01L * quadratic_form(a.error, size);
  return strictly ? most < 0 : most <= 0;
}

bool zero_in_symmetric_part(const MatrixXd& a, Index i) { return (a.row(i).transpose() + a.col(i)).isZero(0); }

// A without the rows and columns that are zero in its symmetric part.
MatrixXd without_zero_rows(const MatrixXd& a) {
  std::vector<Index> kept;
  for (Index i = 0; i < a.rows(); ++i) {
    if (!zero_in_symmetric_part(a, i)) kept.push_back(i);
  }
  return a(kept, kept);
}

// The rows in the order in which Cholesky's method with pivots takes them, as long as a pivot is above `least`.
std::vector<Index> pivots(Matrix a, long double least) {
  std::vector<Index> taken;
  for (Index step = 0; step < a.rows(); ++step) {
    Index pivot = 0;
    if (!(a.diagonal().maxCoeff(&pivot) > least)) break;
    taken.push_back(pivot);
    const Vector column = a.col(pivot) / std::sqrt(a(pivot, pivot));
    a -= column * column.transpose();
    a.row(pivot).setZero();
    a.col(pivot).setZero();
  }
  return taken;
}

Enclosure enclosure(const MatrixXd& a) {
  return symmetric_enclosure(a.cast<long double>(), Matrix::Zero(a.rows(), a.cols()));
}

Proof definite(const Enclosure& a) {
  if (a.middle.rows() == 0) return Proof::holds;
  if (!a.middle.allFinite() || !a.error.allFinite()) return Proof::unknown;
  const auto highest = a.middle.diagonal() + a.error.diagonal();
  if ((highest.array() <= 0).any()) return Proof::fails;
  if ((a.middle.diagonal().array() <= 0).any()) return Proof::unknown;
  const Enclosure scaled = equilibrated(a);
  if (proved_definite(scaled)) return Proof::holds;
  return proved_indefinite(scaled, false) ? Proof::fails : Proof::unknown;
}

}  // namespace

Proof positive_definite(const MatrixXd& a) {
  const Proof proof = definite(enclosure(a));
  if (proof != Proof::unknown || !a.allFinite()) return proof;
  return rank_of_symmetric_part_at_most(a, a.rows() - 1) ? Proof::fails : Proof::unknown;
}

Proof positive_definite(const Matrix& a, const Matrix& error) { return definite(symmetric_enclosure(a, error)); }

Proof positive_semidefinite(const MatrixXd& all) {
  if (!all.allFinite()) return Proof::unknown;
  const MatrixXd a = without_zero_rows(all);
  if (a.rows() == 0) return Proof::holds;
  // A zero on the diagonal beside an entry that is not zero makes an indefinite pair.
  if ((a.diagonal().array() <= 0).any()) return Proof::fails;
  const Enclosure scaled = equilibrated(enclosure(a));
  if (proved_definite(scaled)) return Proof::holds;
  if (proved_indefinite(scaled, true)) return Proof::fails;
  const long double negligible = 1e-15L * static_cast<long double>(a.rows()) * scaled.middle.diagonal().maxCoeff();
  const std::vector<Index> taken = pivots(scaled.middle, negligible);
  const Enclosure taken_part{scaled.middle(taken, taken), scaled.error(taken, taken)};
  const bool holds = proved_definite(taken_part) && rank_of_symmetric_part_at_most(a, static_cast<Index>(taken.size()));
  return holds ? Proof::holds : Proof::unknown;
}

}  // namespace breakaway::stability
