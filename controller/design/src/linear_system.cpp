#include "breakaway/design/linear_system.hpp"

namespace breakaway::design {
namespace {

std::optional<Error> entry_error(const char* name, const Eigen::MatrixXd& matrix, Eigen::Index rows,
                                 Eigen::Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns) {
    return Error{std::string{name} + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
                 "; make it " + std::to_string(rows) + " x " + std::to_string(columns)};
  }
  if (matrix.allFinite()) return std::nullopt;
  return Error{std::string{name} + " has an entry that is not a finite number; correct it"};
}

std::optional<Error> symmetry_error(const char* name, const Eigen::MatrixXd& matrix) {
  if (symmetric(matrix)) return std::nullopt;
  return Error{std::string{name} + " is not symmetric (condition 1 of Theorem 1); its energy needs a symmetric matrix"};
}

}  // namespace

bool symmetric(const Eigen::MatrixXd& matrix) {
  return (matrix - matrix.transpose()).cwiseAbs().maxCoeff() <= 1e-12 * matrix.cwiseAbs().maxCoeff();
}

std::optional<Error> statics_error(const LinearSystem& s) {
  const Eigen::Index n = s.stiffness.rows(), m = s.directions.cols();
  if (n == 0) return Error{"stiffness is empty; give a system at least one coordinate"};
  if (auto error = entry_error("stiffness", s.stiffness, n, n)) return error;
  if (auto error = entry_error("directions", s.directions, n, m)) return error;
  if (auto error = entry_error("friction_N", s.friction_N, m, 1)) return error;
  for (Eigen::Index i = 0; i < m; ++i) {
    if (auto error = unless_not_negative("friction_N[" + std::to_string(i) + "]", s.friction_N[i])) return error;
  }
  return std::nullopt;
}

std::optional<Error> system_error(const LinearSystem& s) {
  const Eigen::Index n = s.mass.rows();
  if (n == 0) return Error{"mass is empty; give a system at least one coordinate"};
  if (auto error = entry_error("mass", s.mass, n, n)) return error;
  if (auto error = entry_error("damping", s.damping, n, n)) return error;
  if (auto error = entry_error("stiffness", s.stiffness, n, n)) return error;
  if (auto error = statics_error(s)) return error;
  if (auto error = symmetry_error("mass", s.mass)) return error;
  return symmetry_error("stiffness", s.stiffness);
}

}  // namespace breakaway::design
