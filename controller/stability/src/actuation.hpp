// Feedback through given actuators can change one part of a matrix and not the rest. Here the two are told apart.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace breakaway::stability {

// The actuators S span `reached`, and Z is its complement: G + S F has the rows Z^T G whatever F is, and any other
// rows.
struct Actuation {
  explicit Actuation(const Eigen::MatrixXd& actuators);

  // The symmetric matrices G + S F are those with Z^T G Z and Z^T G reached as they are, and any symmetric block
  // reached^T (G + S F) reached: this is the one where that block is 0. Z^T G Z must be symmetric.
  Eigen::MatrixXd symmetric_base(const Eigen::MatrixXd& open) const;

  // The symmetric matrices of which these blocks are made, each changed by one entry of the block: l_i l_j^T + l_j
  // l_i^T, and l_i l_i^T, of the columns of `levers`, which has as many as `reached`.
  static std::vector<Eigen::MatrixXd> symmetric_terms(const Eigen::MatrixXd& levers);

  // F of least norm with open + S F = closed, in so far as S can, and of it the nearest for which the stored numbers
  // give a matrix that is symmetric but for their rounding. `closed` is symmetric.
  Eigen::MatrixXd gain(const Eigen::MatrixXd& open, const Eigen::MatrixXd& closed) const;

  Eigen::MatrixXd actuators;  // S
  Eigen::MatrixXd reached;    // n x r, orthonormal
  Eigen::MatrixXd unreached;  // Z: n x (n - r), orthonormal
  Eigen::MatrixXd inverse;    // k x n: the pseudoinverse of S
};

// Rounding may make this much of an entry that is 0, as a share of the matrix's size.
constexpr double rounding = 1e-12;

// "(0.70711, -0.70711)", of unit length and with its largest entry positive.
std::string direction_text(Eigen::VectorXd direction);

}  // namespace breakaway::stability
