#include "breakaway/stability/extended.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace breakaway::stability::extended {

GeneralEigen general_eigen(const Matrix& a) {
  const Eigen::EigenSolver<Matrix> solver(a);
  if (solver.info() != Eigen::Success) return {false, {}, {}};
  return {true, solver.eigenvalues(), solver.eigenvectors()};
}

Matrix symmetric_eigenvectors(const Matrix& a) { return Eigen::SelfAdjointEigenSolver<Matrix>(a).eigenvectors(); }

Matrix inverse_cholesky_factor(const Matrix& a) {
  const Matrix factor = a.llt().matrixL();
  return factor.triangularView<Eigen::Lower>().solve(Matrix::Identity(a.rows(), a.rows()));
}

Matrix inverse(const Matrix& a) {
  if (a.size() == 0) return a;
  return a.partialPivLu().inverse();
}

std::optional<Matrix> inverse_if_regular(const Matrix& a) {
  const Eigen::FullPivLU<Matrix> factors(a);
  if (!factors.isInvertible()) return std::nullopt;
  return factors.inverse();
}

Span span(const Matrix& columns, long double threshold) {
  const Eigen::Index n = columns.rows();
  if (columns.size() == 0) return {Matrix(n, 0), Matrix::Identity(n, n)};
  Eigen::ColPivHouseholderQR<Matrix> qr(n, columns.cols());
  qr.setThreshold(threshold);
  qr.compute(columns);
  const Matrix q = qr.householderQ() * Matrix::Identity(n, n);
  return {q.leftCols(qr.rank()), q.rightCols(n - qr.rank())};
}

}  // namespace breakaway::stability::extended
