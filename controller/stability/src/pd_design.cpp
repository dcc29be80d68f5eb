#include "breakaway/stability/pd_design.hpp"

#include <algorithm>
#include <complex>
#include <limits>

#include "actuation.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/lmi.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double largest(const MatrixXd& matrix) { return matrix.size() == 0 ? 0 : matrix.cwiseAbs().maxCoeff(); }

double skewness(const MatrixXd& matrix) { return largest(matrix - matrix.transpose()); }

// `block` is the part that no actuator can change, and `scale` the size of the whole matrix.
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
  const dense::SymmetricEigen eigen =
      dense::symmetric_eigen(dense::symmetric_part(dense::congruence(actuation.unreached, stiffness)));
  condition.margin = eigen.values[0] - rounding * largest(stiffness);
  condition.holds = condition.margin > 0;
  if (!condition.holds) {
    condition.reason = "the direction " + direction_text(actuation.unreached * eigen.vectors.col(0)) +
                       " has the stiffness " + to_text(eigen.values[0]) +
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

// Directions that friction or an actuator acts on.
MatrixXd acted_on(const ActuatedSystem& system) {
  const MatrixXd frictions = unit_columns(acting_directions(system.machine));
  MatrixXd both(frictions.rows(), frictions.cols() + system.actuators.cols());
  both << frictions, unit_columns(system.actuators);
  return both;
}

// The complex matrix [C - mu I, D] as a real one of twice the size, [Re, -Im; Im, Re]: it has the same singular values,
// each of them twice.
MatrixXd hautus_matrix(const MatrixXd& damping, std::complex<double> mu, const MatrixXd& directions) {
  const Index n = damping.rows(), m = directions.cols();
  MatrixXd hautus = MatrixXd::Zero(2 * n, 2 * (n + m));
  for (const Index half : {0, 1}) {
    hautus.block(half * n, half * (n + m), n, n) = damping;
    hautus.block(half * n, half * (n + m), n, n).diagonal().array() -= mu.real();
    hautus.block(half * n, half * (n + m) + n, n, m) = directions;
  }
  hautus.block(0, n + m, n, n).diagonal().setConstant(mu.imag());
  hautus.block(n, 0, n, n).diagonal().setConstant(-mu.imag());
  return hautus;
}

// The direction in which the matrix of hautus_matrix() is least.
VectorXd least_direction(const MatrixXd& hautus) {
  const Index n = hautus.rows() / 2;
  const VectorXd both = dense::symmetric_eigen(hautus * hautus.transpose()).vectors.col(0);
  Eigen::VectorXcd left(n);
  left.real() = both.head(n);
  left.imag() = both.tail(n);
  // A complex vector is one of a conjugate pair: it is turned so that its real part is the larger one.
  const std::complex<double> turn = std::sqrt((left.array() * left.array()).sum());
  return std::abs(turn) > 0 ? VectorXd{(left * (std::abs(turn) / turn)).real()} : VectorXd{left.real()};
}

// Hautus: for every eigenvalue mu of C with Re mu <= 0 the matrix [C - mu I, W, S] must have the rank n. Its least
// singular value, C being scaled to the size 1, is the margin.
Condition stabilizable(const ActuatedSystem& system) {
  const double scale = std::max(system.machine.damping.norm(), std::numeric_limits<double>::min());
  const MatrixXd damping = system.machine.damping / scale, directions = acted_on(system);
  Condition condition{"stabilizable", true, std::numeric_limits<double>::infinity(), ""};
  for (const std::complex<double> mu : dense::general_eigen(damping).values) {
    if (mu.real() > rounding) continue;
    const MatrixXd hautus = hautus_matrix(damping, mu, directions);
    const double least = dense::least_singular_value(hautus);
    if (!(least < condition.margin)) continue;
    condition.margin = least;
    condition.reason = "the direction " + direction_text(least_direction(hautus)) + " has the damping " +
                       to_text(mu.real() * scale) +
                       " N s/m, and neither friction nor an actuator acts on it: add one of them";
  }
  condition.holds = condition.margin > rounding;
  if (condition.holds) condition.reason.clear();
  return condition;
}

// certify_attractivity() asks the same of K. Of C it takes the symmetric part.
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
  const auto unreached = [&](const MatrixXd& matrix) { return dense::congruence(actuation.unreached, matrix); };
  const MatrixXd &stiffness = system.machine.stiffness, &damping = system.machine.damping;
  return {unreached_symmetric("stiffness_symmetric", unreached(stiffness), largest(stiffness)),
          unreached_stiffness_positive(actuation, stiffness),
          unreached_symmetric("damping_symmetric", unreached(damping), largest(damping)), stabilizable(system)};
}

std::vector<Condition> loop_conditions(const LinearMachine<>& closed_loop) {
  Condition stiffness = symmetry("K_cl symmetric", closed_loop.stiffness);
  Condition positive{"K_cl positive definite", false, 0, ""};
  positive.margin = proven_least_eigenvalue(dense::symmetric_part(closed_loop.stiffness));
  positive.holds = positive.margin > 0;
  if (!positive.holds) positive.reason = "its least eigenvalue is not positive: add feedback of position";

  Condition span{"eigencolumns in span W", true, std::numeric_limits<double>::infinity(), ""};
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(dense::symmetric_part(closed_loop.damping));
  const MatrixXd complement = spanned_space(acting_directions(closed_loop)).complement;
  const double zero = 1e-15 * static_cast<double>(complement.rows()) * closed_loop.damping.norm();
  for (Index i = 0; i < complement.rows() && eigen.values[i] <= zero; ++i) {
    const double outside = (complement.transpose() * eigen.vectors.col(i)).norm();
    span.margin = std::min(span.margin, 1e-9 - outside);
    if (span.margin >= 0) continue;
    span.holds = false;
    span.reason = "the direction " + direction_text(eigen.vectors.col(i)) + " with the damping " +
                  to_text(eigen.values[i]) + " N s/m is not a sum of friction directions: damp it by feedback";
  }
  return {stiffness, positive, span, symmetry("C_cl symmetric", closed_loop.damping)};
}

Theorem2 verify_theorem_2(const ActuatedSystem& system, const MatrixXd& position_gain_N_per_m) {
  const MatrixXd& stiffness = system.machine.stiffness;
  const MatrixXd closed = stiffness + system.actuators * position_gain_N_per_m;
  Theorem2 result;
  result.A = -dense::symmetric_part(dense::inverse(closed));
  result.Y = position_gain_N_per_m * result.A;
  result.hurwitz = proven_least_eigenvalue(-result.A);
  result.lmi = proven_least_eigenvalue(-2 * dense::symmetric_part(stiffness * result.A + system.actuators * result.Y));
  return result;
}

}  // namespace breakaway::stability
