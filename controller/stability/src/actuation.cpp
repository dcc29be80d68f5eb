#include "actuation.hpp"

#include <Eigen/SVD>
#include <cstdio>

namespace breakaway::stability {

using Eigen::MatrixXd;

Actuation::Actuation(const MatrixXd& actuators) {
  Eigen::JacobiSVD<MatrixXd, Eigen::FullPivHouseholderQRPreconditioner> svd(actuators,
                                                                            Eigen::ComputeFullU | Eigen::ComputeFullV);
  svd.setThreshold(rounding);
  const Eigen::Index rank = svd.rank();
  reached = svd.matrixU().leftCols(rank);
  unreached = svd.matrixU().rightCols(actuators.rows() - rank);
  inverse =
      svd.matrixV().leftCols(rank) * svd.singularValues().head(rank).cwiseInverse().asDiagonal() * reached.transpose();
}

MatrixXd Actuation::symmetric_base(const MatrixXd& open) const {
  const MatrixXd coupling = unreached * (unreached.transpose() * open * reached) * reached.transpose();
  const MatrixXd fixed = unreached * (unreached.transpose() * open * unreached) * unreached.transpose();
  return coupling + coupling.transpose() + (fixed + fixed.transpose()) / 2;
}

std::vector<MatrixXd> Actuation::symmetric_terms(const MatrixXd& levers) {
  std::vector<MatrixXd> terms;
  for (Eigen::Index i = 0; i < levers.cols(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      terms.emplace_back(levers.col(i) * levers.col(j).transpose());
      if (j < i) terms.back() += terms.back().transpose().eval();
    }
  }
  return terms;
}

MatrixXd Actuation::gain(const MatrixXd& open, const MatrixXd& closed) const { return inverse * (closed - open); }

std::string direction_text(Eigen::VectorXd direction) {
  direction.normalize();
  Eigen::Index largest = 0;
  if (direction.cwiseAbs().maxCoeff(&largest); direction[largest] < 0) direction = -direction;
  std::string text;
  for (const double entry : direction) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.5g", std::abs(entry) < rounding ? 0.0 : entry);
    text += (text.empty() ? "(" : ", ") + std::string{digits};
  }
  return text + ")";
}

}  // namespace breakaway::stability
