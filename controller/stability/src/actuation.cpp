#include "actuation.hpp"

#include <cstdio>

#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/extended.hpp"

namespace breakaway::stability {

using Eigen::MatrixXd;

Actuation::Actuation(const MatrixXd& s) : actuators{s} {
  const dense::Span span = dense::span(actuators, rounding);
  reached = span.basis;
  unreached = span.complement;
  inverse = dense::solution(actuators, MatrixXd::Identity(actuators.rows(), actuators.rows()), rounding);
}

MatrixXd Actuation::symmetric_base(const MatrixXd& open) const {
  const MatrixXd onto_reached = reached * reached.transpose(), onto_unreached = unreached * unreached.transpose();
  const MatrixXd kept = onto_unreached * open, coupling = kept * onto_reached;
  return coupling + coupling.transpose() + dense::symmetric_part(kept * onto_unreached);
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

// With P and Q the projections on what the actuators reach and do not, and N the skew part of open + S F, the change
// S dF = -P N (P / 2 + Q) takes all of N away but Q N Q, which no gain can change.
MatrixXd Actuation::gain(const MatrixXd& open, const MatrixXd& closed) const {
  constexpr int corrections = 3;
  const extended::Matrix s = actuators.cast<long double>(), reach = reached.cast<long double>();
  const extended::Matrix onto_reached = reach * reach.transpose();
  const extended::Matrix weight = extended::Matrix::Identity(open.rows(), open.rows()) - onto_reached / 2;
  MatrixXd result = inverse * (closed - open);
  for (int i = 0; i < corrections; ++i) {
    const extended::Matrix loop = open.cast<long double>() + s * result.cast<long double>();
    const extended::Matrix skew = loop - loop.transpose();
    result -= inverse * (onto_reached * skew * weight).cast<double>();
  }
  return result;
}

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
