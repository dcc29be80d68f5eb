#include "breakaway/stability/pd_design.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <complex>
#include <limits>

#include "actuation.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/lmi.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double largest(const MatrixXd& matrix) { return matrix.size() == 0 ? 0 : matrix.cwiseAbs().maxCoeff(); }

double skewness(const MatrixXd& matrix) { return largest(matrix - matrix.transpose()); }

// Of what no actuator can change; `scale` is the size of the whole matrix.
Condition unreached_symmetric(const char* name, const MatrixXd& block, double scale) {
  Condition condition{name, false, rounding * scale - skewness(block), ""};
  condition.holds = condition.margin >= 0;
  if (!condition.holds) {
    condition.reason =
        "where no actuator acts it is not symmetric, by up to " + to_text(skewness(block)) + ": add an actuator there";
  }
  return condition;
}

Condition unreached_stiffness_positive(const Actuation& actuation, const MatrixXd& stiffness) {
  Condition condition{"stiffness_positive", true, std::numeric_limits<double>::infinity(), ""};
  if (actuation.unreached.cols() == 0) return condition;
  const MatrixXd block = actuation.unreached.transpose() * stiffness * actuation.unreached;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen((block + block.transpose()) / 2);
  condition.margin = eigen.eigenvalues()[0] - rounding * largest(stiffness);
  condition.holds = condition.margin > 0;
  if (!condition.holds) {
    condition.reason = "the direction " + direction_text(actuation.unreached * eigen.eigenvectors().col(0)) +
                       " has the stiffness " + to_text(eigen.eigenvalues()[0]) +
                       " N/m and no actuator acts on it: add one, or a spring";
  }
  return condition;
}

// Columns of unit length, so that no unit of force decides about the rank. Columns of zeros stay.
MatrixXd unit_columns(MatrixXd matrix) {
  for (Index j = 0; j < matrix.cols(); ++j) matrix.col(j) = matrix.col(j).stableNormalized();
  return matrix;
}

// Frictions without force hold nothing.
MatrixXd acting_directions(const LinearMachine<>& machine) {
  return machine.directions * (machine.friction_N.array() > 0).cast<double>().matrix().asDiagonal();
}

// Hautus: for every eigenvalue mu of C with Re mu <= 0 the matrix [C - mu I, W, S] must have the rank n. Its least
// singular value, C being scaled to the size 1, is the margin.
Condition stabilizable(const ActuatedSystem& system) {
  const LinearMachine<>& machine = system.machine;
  const Index n = machine.damping.rows();
  const double scale = std::max(machine.damping.norm(), std::numeric_limits<double>::min());
  const MatrixXd damping = machine.damping / scale;
  MatrixXcd hautus(n, n + machine.directions.cols() + system.actuators.cols());
  hautus.rightCols(hautus.cols() - n) << unit_columns(acting_directions(machine)), unit_columns(system.actuators);

  Condition condition{"stabilizable", true, std::numeric_limits<double>::infinity(), ""};
  for (const std::complex<double> mu : damping.eigenvalues()) {
    if (mu.real() > rounding) continue;
    hautus.leftCols(n) = damping.cast<std::complex<double>>() - mu * MatrixXcd::Identity(n, n);
    const Eigen::JacobiSVD<MatrixXcd> svd(hautus, Eigen::ComputeThinU);
    if (const double least = svd.singularValues()[n - 1]; least < condition.margin) {
      condition.margin = least;
      // A complex vector is one of a conjugate pair: turned so that its real part is the larger one.
      const Eigen::VectorXcd left = svd.matrixU().col(n - 1);
      const std::complex<double> turn = std::sqrt((left.array() * left.array()).sum());
      const VectorXd direction = std::abs(turn) > 0 ? VectorXd{(left * (std::abs(turn) / turn)).real()} : left.real();
      condition.reason = "the direction " + direction_text(direction) + " has the damping " +
                         to_text(mu.real() * scale) +
                         " N s/m, and neither friction nor an actuator acts on it: add one of them";
    }
  }
  condition.holds = condition.margin > rounding;
  if (condition.holds) condition.reason.clear();
  return condition;
}

// As certify_attractivity() asks of K; of C it takes the symmetric part.
Condition symmetry(const char* name, const MatrixXd& matrix) {
  Condition condition{name, symmetric(matrix), rounding * largest(matrix) - skewness(matrix), ""};
  if (!condition.holds)
    condition.reason = "entries differ by up to " + to_text(skewness(matrix)) + " across the diagonal";
  return condition;
}

}  // namespace

LinearMachine<> closed_loop(const ActuatedSystem& system, const PdGains& gains) {
  return with_feedback(system.machine, system.actuators, gains.position_N_per_m, gains.velocity_Ns_per_m);
}

std::vector<Condition> machine_conditions(const ActuatedSystem& system) {
  const Actuation actuation{system.actuators};
  const auto unreached = [&](const MatrixXd& matrix) {
    return MatrixXd{actuation.unreached.transpose() * matrix * actuation.unreached};
  };
  const MatrixXd &stiffness = system.machine.stiffness, &damping = system.machine.damping;
  return {unreached_symmetric("stiffness_symmetric", unreached(stiffness), largest(stiffness)),
          unreached_stiffness_positive(actuation, stiffness),
          unreached_symmetric("damping_symmetric", unreached(damping), largest(damping)), stabilizable(system)};
}

std::vector<Condition> loop_conditions(const LinearMachine<>& closed_loop) {
  Condition stiffness = symmetry("K_cl symmetric", closed_loop.stiffness);
  Condition positive{"K_cl positive definite", false, 0, ""};
  positive.margin = proven_least_eigenvalue((closed_loop.stiffness + closed_loop.stiffness.transpose()) / 2);
  positive.holds = positive.margin > 0;
  if (!positive.holds) positive.reason = "its least eigenvalue is not positive: add feedback of position";

  Condition span{"eigencolumns in span W", true, std::numeric_limits<double>::infinity(), ""};
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen((closed_loop.damping + closed_loop.damping.transpose()) / 2);
  const MatrixXd complement = spanned_space(acting_directions(closed_loop)).complement;
  const double zero = 1e-15 * static_cast<double>(complement.rows()) * closed_loop.damping.norm();
  for (Index i = 0; i < complement.rows() && eigen.eigenvalues()[i] <= zero; ++i) {
    const double outside = (complement.transpose() * eigen.eigenvectors().col(i)).norm();
    span.margin = std::min(span.margin, 1e-9 - outside);
    if (span.margin >= 0) continue;
    span.holds = false;
    span.reason = "the direction " + direction_text(eigen.eigenvectors().col(i)) + " with the damping " +
                  to_text(eigen.eigenvalues()[i]) + " N s/m is not a sum of friction directions: damp it by feedback";
  }
  return {stiffness, positive, span, symmetry("C_cl symmetric", closed_loop.damping)};
}

Theorem2 verify_theorem_2(const ActuatedSystem& system, const MatrixXd& position_gain_N_per_m) {
  const MatrixXd& stiffness = system.machine.stiffness;
  const MatrixXd closed = stiffness + system.actuators * position_gain_N_per_m;
  Theorem2 result;
  const MatrixXd inverse = closed.inverse();
  result.A = -(inverse + inverse.transpose()) / 2;
  result.Y = position_gain_N_per_m * result.A;
  const MatrixXd half = stiffness * result.A + system.actuators * result.Y;
  result.hurwitz = proven_least_eigenvalue(-result.A);
  result.lmi = proven_least_eigenvalue(-(half + half.transpose()));
  return result;
}

}  // namespace breakaway::stability
