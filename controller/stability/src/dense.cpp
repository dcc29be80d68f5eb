#include "breakaway/stability/dense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <limits>

#include "breakaway/stability/extended.hpp"

namespace breakaway::stability::dense {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// L^-1 A L^-T, whose eigenvalues are those of A x = lambda L L^T x.
MatrixXd reduced(const MatrixXd& a, const Cholesky& b) { return b.solve_lower(b.solve_lower(a).transpose()); }

double rounding(const MatrixXd& a) {
  return std::numeric_limits<double>::epsilon() * static_cast<double>(std::min(a.rows(), a.cols()));
}

}  // namespace

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen symmetric_eigen(const MatrixXd& a, const MatrixXd& b) {
  const Cholesky factors(b);
  SymmetricEigen eigen = symmetric_eigen(reduced(a, factors));
  eigen.vectors = factors.solve_upper(eigen.vectors);
  return eigen;
}

VectorXd symmetric_eigenvalues(const MatrixXd& a) {
  return Eigen::SelfAdjointEigenSolver<MatrixXd>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd symmetric_eigenvalues(const MatrixXd& a, const MatrixXd& b) {
  return symmetric_eigenvalues(reduced(a, Cholesky(b)));
}

// It calculates in extended precision, because there the solver is compiled already, for the closed forms of motion.
GeneralEigen general_eigen(const MatrixXd& a) {
  const extended::GeneralEigen eigen = extended::general_eigen(a.cast<long double>());
  return {eigen.values.cast<std::complex<double>>(), eigen.vectors.cast<std::complex<double>>()};
}

double spectral_norm(const MatrixXd& a) {
  if (a.size() == 0) return 0;
  return std::sqrt(symmetric_eigenvalues(a * a.transpose()).tail<1>()[0]);
}

// The eigenvalues of [0 A; A^T 0] are the singular values of A, their negatives and zeros. Those of A A^T would lose
// half of the digits.
double least_singular_value(const MatrixXd& a) {
  const Index rows = a.rows(), columns = a.cols();
  MatrixXd both = MatrixXd::Zero(rows + columns, rows + columns);
  both.bottomLeftCorner(columns, rows) = a.transpose();
  return std::max(0.0, symmetric_eigenvalues(both)[columns]);
}

Cholesky::Cholesky(const MatrixXd& a) {
  const Eigen::LLT<MatrixXd> factors(a);
  succeeded_ = factors.info() == Eigen::Success;
  lower_ = factors.matrixL();
}

MatrixXd Cholesky::solve(const MatrixXd& right) const { return solve_upper(solve_lower(right)); }

MatrixXd Cholesky::inverse() const { return solve(MatrixXd::Identity(lower_.rows(), lower_.rows())); }

MatrixXd Cholesky::solve_lower(const MatrixXd& right) const {
  MatrixXd result = right;
  if (right.size() > 0) lower_.triangularView<Eigen::Lower>().solveInPlace(result);
  return result;
}

MatrixXd Cholesky::solve_upper(const MatrixXd& right) const {
  MatrixXd result = right;
  if (right.size() > 0) lower_.transpose().triangularView<Eigen::Upper>().solveInPlace(result);
  return result;
}

double Cholesky::reciprocal_condition() const {
  const auto norm = [](const MatrixXd& matrix) { return matrix.cwiseAbs().colwise().sum().maxCoeff(); };
  return 1 / (norm(lower_ * lower_.transpose()) * norm(inverse()));
}

Span span(const MatrixXd& columns, double threshold) {
  const Index n = columns.rows();
  if (columns.size() == 0) return {MatrixXd(n, 0), MatrixXd::Identity(n, n)};
  Eigen::ColPivHouseholderQR<MatrixXd> qr(n, columns.cols());
  qr.setThreshold(threshold);
  qr.compute(columns);
  const MatrixXd q = qr.householderQ() * MatrixXd::Identity(n, n);
  return {q.leftCols(qr.rank()), q.rightCols(n - qr.rank())};
}

Span span(const MatrixXd& columns) { return span(columns, rounding(columns)); }

VectorXd normal(const MatrixXd& columns) {
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
  if (qr.rank() < columns.cols()) return {};
  return qr.householderQ() * VectorXd::Unit(columns.rows(), columns.cols());
}

MatrixXd solution(const MatrixXd& a, const MatrixXd& right, double threshold) {
  if (a.size() == 0) return MatrixXd::Zero(a.cols(), right.cols());
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition(a.rows(), a.cols());
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return decomposition.solve(right);
}

MatrixXd solution(const MatrixXd& a, const MatrixXd& right) { return solution(a, right, rounding(a)); }

MatrixXd inverse(const MatrixXd& a) { return extended::inverse(a.cast<long double>()).cast<double>(); }

MatrixXd congruence(const MatrixXd& u, const MatrixXd& a) { return u.transpose() * (a * u); }

MatrixXd symmetric_part(const MatrixXd& a) { return (a + a.transpose()) / 2; }

}  // namespace breakaway::stability::dense
