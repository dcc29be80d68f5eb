#include "damping_family.hpp"

#include <utility>

#include "breakaway/stability/dense.hpp"
#include "gain_search.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd identity(Index size) { return MatrixXd::Identity(size, size); }

}  // namespace

DampingFamily::DampingFamily(const ActuatedSystem& system, const Actuation& actuation, Split split, double unit_per_s)
    : actuation_{actuation}, split_{std::move(split)}, unit_{unit_per_s}, actuator_unit_{system.actuators.norm()} {
  open_ = system.machine.damping / unit_;
  inverse_ = actuation.inverse * actuator_unit_;
  base_ = actuation.symmetric_base(open_);
  terms_ = Actuation::symmetric_terms(actuation.reached);
  keep_invariant();
}

double DampingFamily::least_limit() const {
  LmiProblem problem = program();
  const Index limit = count() + 1;
  problem.cost.conservativeResize(count() + 2);
  problem.cost[count()] = reserve;
  problem.cost[limit] = 1;
  problem.matrices.push_back(above(split_.subspace, 0));
  problem.matrices.back().terms.emplace_back(limit, identity(split_.subspace.cols()));
  problem.rows = VectorXd::Unit(count() + 2, limit).transpose();  // below 0 there may be no end
  problem.offsets = VectorXd::Zero(1);
  return minimised(problem)[limit];
}

MatrixXd DampingFamily::least_gain(double limit) const {
  LmiProblem problem = program();
  if (split_.subspace.cols() > 0) problem.matrices.push_back(above(split_.subspace, -limit));
  const MatrixXd closed = dense::symmetric_part(base_ + combined(minimised(problem).head(count())));
  return MatrixXd{unit_ * actuation_.gain(open_, closed)};
}

// complement^T C_cl subspace = 0: what is left of the family is where these linear equations hold.
void DampingFamily::keep_invariant() {
  const MatrixXd &p = split_.complement, &n = split_.subspace;
  if (p.cols() == 0 || n.cols() == 0) return;
  MatrixXd equations(p.cols() * n.cols(), count());
  for (Index k = 0; k < count(); ++k)
    equations.col(k) = (p.transpose() * terms_[static_cast<std::size_t>(k)] * n).reshaped();
  const VectorXd right = -(p.transpose() * base_ * n).reshaped();
  const VectorXd particular = dense::solution(equations, right);
  exists_ = (equations * particular - right).norm() <= 1e-10;
  const MatrixXd free = dense::span(equations.transpose()).complement;
  std::vector<MatrixXd> left;
  for (const auto& direction : free.colwise()) left.push_back(combined(direction));
  base_ += combined(particular);
  terms_ = std::move(left);
}

MatrixXd DampingFamily::combined(const VectorXd& weights) const {
  MatrixXd sum = MatrixXd::Zero(base_.rows(), base_.cols());
  for (Index k = 0; k < count(); ++k) sum += weights[k] * terms_[static_cast<std::size_t>(k)];
  return sum;
}

// U^T C_cl U - least I >= 0.
MatrixInequality DampingFamily::above(const MatrixXd& basis, double least) const {
  MatrixInequality inequality{dense::congruence(basis, base_) - least * identity(basis.cols()), {}};
  for (Index k = 0; k < count(); ++k)
    inequality.terms.emplace_back(k, dense::congruence(basis, terms_[static_cast<std::size_t>(k)]));
  return inequality;
}

// minimise t with |F2| <= t, which is [t I, F2; F2^T, t I] >= 0, and the complement's damping above the reserve.
LmiProblem DampingFamily::program() const {
  const Index k = inverse_.rows(), n = base_.rows();
  const auto gain = [&](const MatrixXd& change) {
    MatrixXd block = MatrixXd::Zero(k + n, k + n);
    block.topRightCorner(k, n) = inverse_ * change;
    block.bottomLeftCorner(n, k) = block.topRightCorner(k, n).transpose();
    return block;
  };
  LmiProblem problem;
  problem.cost = VectorXd::Unit(count() + 1, count());
  problem.matrices.push_back({gain(base_ - open_), {}});
  for (Index i = 0; i < count(); ++i)
    problem.matrices[0].terms.emplace_back(i, gain(terms_[static_cast<std::size_t>(i)]));
  problem.matrices[0].terms.emplace_back(count(), identity(k + n));
  if (split_.complement.cols() > 0)
    problem.matrices.push_back(above(split_.complement, damping_reserve * (1 + reserve)));
  return problem;
}

}  // namespace breakaway::stability
