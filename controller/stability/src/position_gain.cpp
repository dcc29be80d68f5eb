// F1 by linear matrix inequalities in the compliance Q = K_cl^-1.
//
// In the basis [S_r, Z] of what the actuators reach and what they do not, K_cl = [X, B; B^T, D] with any symmetric X.
// With Y = (X - B D^-1 B^T)^-1 its inverse is Q = Z D^-1 Z^T + L Y L^T, L = S_r - Z D^-1 B^T, and K_cl is positive
// definite just when D and Y are: Q, and with it every resting position Q W lambda, is linear in Y.
#include <algorithm>
#include <utility>

#include "actuation.hpp"
#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/lmi.hpp"
#include "gain_search.hpp"
#include "scaled_system.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Semidefinite programs with more are a matter of hours.
constexpr Index most_variables = 3000;

// The closed loop keeps this share of the machine's own stiffness: with less, gains would cancel its springs to the
// last digits.
constexpr double least_stiffness = 0.01;

// It calculates in units in which the wanted resting errors and the largest friction are 1. `system` is in the former.
class ComplianceProgram {
 public:
  ComplianceProgram(const ActuatedSystem& system, const Actuation& actuation)
      : reached_{actuation.reached}, base_{actuation.symmetric_base(system.machine.stiffness)} {
    pushes_ = system.machine.directions * system.machine.friction_N.asDiagonal();
    const double force_N = pushes_.cwiseAbs().rowwise().sum().maxCoeff();
    unit_ = 1 / force_N;
    pushes_ /= force_N;
    const MatrixXd& z = actuation.unreached;
    const MatrixXd unreached_compliance = z * dense::inverse(dense::congruence(z, base_)) * z.transpose();
    fixed_ = dense::symmetric_part(unreached_compliance) / unit_;
    levers_ = reached_ - unreached_compliance * base_ * reached_;
    terms_ = Actuation::symmetric_terms(levers_);
    most_compliant_ = std::min(1e4, 1 / (least_stiffness * system.machine.stiffness.norm() * unit_));
  }

  Index variables() const { return entries() + pushes_.size() + 2; }

  // The least resting error, relative to the one wanted.
  double least_error() const {
    LmiProblem problem = resting(/*error_is_free=*/true);
    problem.cost[entries()] = 1;
    problem.cost[entries() + 1] = reserve;  // directions that no friction acts on would leave Q unbounded
    problem.matrices.push_back(bounded_by(entries() + 1, -1));
    problem.matrices.push_back({MatrixXd::Zero(reached_.cols(), reached_.cols()), unit_terms()});
    return (compliance(minimised(problem)) * pushes_).cwiseAbs().rowwise().sum().maxCoeff();
  }

  // K_cl of the greatest least compliance, and nearly that which is the roundest of those.
  MatrixXd softest_stiffness() const {
    LmiProblem problem = resting(/*error_is_free=*/false);
    problem.cost[entries()] = -1;
    problem.cost[entries() + 1] = 1e-3;
    problem.matrices.push_back(bounded_by(entries(), 1));
    problem.matrices.push_back(bounded_by(entries() + 1, -1));
    return stiffness(minimised(problem));
  }

 private:
  // Variables: the entries of Y, two bounds, and the sizes |(Q W)_ij| p_j.
  Index entries() const { return static_cast<Index>(terms_.size()); }

  // sum_j |(Q W)_ij| p_j <= 1, or <= the variable entries() when that is free.
  LmiProblem resting(bool error_is_free) const {
    const Index n = pushes_.rows(), m = pushes_.cols();
    LmiProblem problem;
    problem.cost = VectorXd::Zero(variables());
    problem.rows = MatrixXd::Zero(2 * n * m + n, variables());
    problem.offsets = VectorXd::Zero(2 * n * m + n);
    const MatrixXd rest = fixed_ * pushes_;
    for (Index side = 0; side < 2; ++side) {
      const double sign = side == 0 ? 1 : -1;
      problem.offsets.segment(side * n * m, n * m) = sign * rest.reshaped();
      for (Index k = 0; k < entries(); ++k)
        problem.rows.col(k).segment(side * n * m, n * m) =
            sign * (terms_[static_cast<std::size_t>(k)] * pushes_).reshaped();
      problem.rows.block(side * n * m, entries() + 2, n * m, n * m).setIdentity();
    }
    for (Index i = 0; i < n; ++i) {
      const Index row = 2 * n * m + i;
      for (Index j = 0; j < m; ++j) problem.rows(row, entries() + 2 + j * n + i) = -1;
      error_is_free ? static_cast<void>(problem.rows(row, entries()) = 1)
                    : static_cast<void>(problem.offsets[row] = 1 - reserve);
    }
    const Index r = reached_.cols();
    problem.matrices.push_back({most_compliant_ * MatrixXd::Identity(r, r), {}});
    for (const auto& [k, unit] : unit_terms()) problem.matrices[0].terms.emplace_back(k, -unit);
    return problem;
  }

  // Q - t I >= 0 for the sign 1, t I - Q >= 0 for -1.
  MatrixInequality bounded_by(Index variable, double sign) const {
    MatrixInequality inequality{sign * fixed_, {}};
    for (Index k = 0; k < entries(); ++k) inequality.terms.emplace_back(k, sign * terms_[static_cast<std::size_t>(k)]);
    inequality.terms.emplace_back(variable, -sign * MatrixXd::Identity(fixed_.rows(), fixed_.cols()));
    return inequality;
  }

  // Y.
  MatrixXd free_compliance(const VectorXd& x) const {
    MatrixXd y = MatrixXd::Zero(reached_.cols(), reached_.cols());
    for (const auto& [k, unit] : unit_terms()) y += x[k] * unit;
    return y;
  }

  std::vector<std::pair<Index, MatrixXd>> unit_terms() const {
    std::vector<std::pair<Index, MatrixXd>> terms;
    for (const MatrixXd& unit : Actuation::symmetric_terms(MatrixXd::Identity(reached_.cols(), reached_.cols())))
      terms.emplace_back(static_cast<Index>(terms.size()), unit);
    return terms;
  }

  MatrixXd compliance(const VectorXd& x) const { return fixed_ + levers_ * free_compliance(x) * levers_.transpose(); }

  MatrixXd stiffness(const VectorXd& x) const {
    const dense::Cholesky y(free_compliance(x));
    if (!y.succeeded())
      throw InputError{
          "the solver sdpa returned gains that do not make K_cl positive definite; ask for a larger resting error, or "
          "use identical gains"};
    const MatrixXd coupling = base_ * reached_;                                // Z B^T
    const MatrixXd held = dense::congruence(coupling, fixed_) * unit_;         // B D^-1 B^T
    const MatrixXd block = dense::symmetric_part(held + y.inverse() / unit_);  // X
    return base_ + dense::congruence(reached_.transpose(), block);
  }

  MatrixXd reached_, base_, pushes_, fixed_, levers_;
  double unit_;            // 1 / J
  double most_compliant_;  // Y at most this
  std::vector<MatrixXd> terms_;
};

}  // namespace

MatrixXd full_position_gain(const ActuatedSystem& system, const VectorXd& limit_m, double wanted_m,
                            const SearchProgress& progress) {
  const ScaledSystem scaled{system, limit_m};
  const Actuation actuation{scaled.system.actuators};
  const ComplianceProgram program{scaled.system, actuation};
  if (program.variables() > most_variables) {
    throw InputError{"full gains of this machine need a program of " + std::to_string(program.variables()) +
                     " variables, which is too many; use identical gains or merge frictions"};
  }
  const double least = program.least_error();
  progress.at(0.5);
  if (least > 1 - 2 * reserve) {
    throw InputError{"a resting error of " + to_text(wanted_m) +
                     " m is out of reach: with these actuators the best is about " + to_text(least * wanted_m) +
                     " m; ask for less, or add actuators"};
  }
  return scaled.gain(
      actuation.gain(scaled.system.machine.stiffness, dense::symmetric_part(program.softest_stiffness())));
}

}  // namespace breakaway::stability
