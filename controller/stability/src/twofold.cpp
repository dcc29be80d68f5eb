#include "breakaway/stability/twofold.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

namespace breakaway::stability::twofold {
namespace {

// Powers of two that bring the largest entry of each row, and then of each column, near one: else the search for pivots
// would compare numbers of different units.
struct Equilibrated {
  Matrix matrix;
  Vector rows, columns;

  explicit Equilibrated(const Matrix& a) : matrix{a}, rows(a.rows()), columns(a.cols()) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) matrix.row(i) *= rows[i] = scale(matrix.row(i));
    for (Eigen::Index i = 0; i < a.cols(); ++i) matrix.col(i) *= columns[i] = scale(matrix.col(i));
  }
  Matrix unscaled(const Matrix& inverse) const { return columns.asDiagonal() * inverse * rows.asDiagonal(); }

  static double scale(const Matrix& line) {
    double largest = 0;
    for (const Scalar& entry : line.reshaped()) largest = std::max(largest, std::abs(entry.high()));
    return largest > 0 && std::isfinite(largest) ? std::ldexp(1.0, -std::ilogb(largest)) : 1;
  }
};

}  // namespace

RealSchur real_schur(const Matrix& a) {
  const Eigen::RealSchur<Matrix> solver(a);
  if (solver.info() != Eigen::Success) return {false, {}, {}};
  return {true, solver.matrixT(), solver.matrixU()};
}

Matrix symmetric_eigenvectors(const Matrix& a) { return Eigen::SelfAdjointEigenSolver<Matrix>(a).eigenvectors(); }

Matrix inverse_cholesky_factor(const Matrix& a) {
  const Matrix factor = a.llt().matrixL();
  return factor.triangularView<Eigen::Lower>().solve(Matrix::Identity(a.rows(), a.rows()));
}

Matrix inverse(const Matrix& a) {
  if (a.size() == 0) return a;
  const Equilibrated scaled(a);
  return scaled.unscaled(scaled.matrix.partialPivLu().inverse());
}

std::optional<Matrix> inverse_if_regular(const Matrix& a) {
  if (a.size() == 0) return a;
  const Equilibrated scaled(a);
  const Eigen::FullPivLU<Matrix> factors(scaled.matrix);
  if (!factors.isInvertible()) return std::nullopt;
  return scaled.unscaled(factors.inverse());
}

Matrix orthonormalised(const Matrix& columns) {
  return Eigen::HouseholderQR<Matrix>(columns).householderQ() * Matrix::Identity(columns.rows(), columns.cols());
}

Span span(const Matrix& columns, double threshold) {
  const Eigen::Index n = columns.rows();
  if (columns.size() == 0) return {Matrix(n, 0), Matrix::Identity(n, n)};
  Eigen::ColPivHouseholderQR<Matrix> qr(n, columns.cols());
  qr.setThreshold(threshold);
  qr.compute(columns);
  const Matrix q = qr.householderQ() * Matrix::Identity(n, n);
  return {q.leftCols(qr.rank()), q.rightCols(n - qr.rank())};
}

}  // namespace breakaway::stability::twofold
