#include "breakaway/stability/pd_design.hpp"

#include <algorithm>
#include <complex>
#include <limits>

#include "actuation.hpp"
#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/definite_proof.hpp"
#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/lmi.hpp"
#include "scaled_system.hpp"
#include "zonotope.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double entry_rounding = std::numeric_limits<double>::epsilon();

double largest(const MatrixXd& matrix) { return matrix.size() == 0 ? 0 : matrix.cwiseAbs().maxCoeff(); }

// What keeps a matrix from being symmetric, without what the rounding of its entries explains.
MatrixXd skew_part(const MatrixXd& matrix) {
  const auto skew = (matrix - matrix.transpose()).array();
  const auto size = matrix.cwiseAbs().cwiseMax(matrix.transpose().cwiseAbs()).array();
  return (skew.abs() > entry_rounding * size).select(skew, 0).matrix();
}

// Z^T A Z is the part of `matrix` that no actuator can change.
Condition unreached_symmetric(const char* name, const MatrixXd& z, const MatrixXd& matrix) {
  const MatrixXd skew = skew_part(matrix);
  const double found = largest(dense::congruence(z, skew));
  const double rounding = 64 * static_cast<double>(matrix.rows()) * entry_rounding * skew.norm();
  Condition condition{name, found <= rounding, rounding - found, ""};
  if (!condition.holds) {
    condition.reason =
        "where no actuator acts it is not symmetric, by up to " + to_text(found) + " per kg: add an actuator there";
  }
  return condition;
}

// Proved for Z as far as it is known.
Condition unreached_stiffness_positive(const ScaledSystem& scaled, const MatrixXd& z) {
  Condition condition{"stiffness_positive", true, std::numeric_limits<double>::infinity(), ""};
  if (z.cols() == 0) return condition;
  const MatrixXd stiffness = dense::symmetric_part(scaled.system.machine.stiffness);
  const MatrixXd block = dense::congruence(z, stiffness), size = dense::congruence(z.cwiseAbs(), stiffness.cwiseAbs());
  const double share = 8 * static_cast<double>(stiffness.rows()) * entry_rounding;
  condition.holds = positive_definite(block.cast<long double>(), share * size.cast<long double>()) == Proof::holds;
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(dense::symmetric_part(block));
  condition.margin =
      condition.holds ? std::max(eigen.values[0], std::numeric_limits<double>::min()) : std::min(eigen.values[0], 0.0);
  if (!condition.holds) {
    condition.reason = "the direction " + direction_text(scaled.direction(z * eigen.vectors.col(0))) +
                       " has the stiffness " + to_text(eigen.values[0]) +
                       " N/m per kg and no actuator acts on it: add one, or a spring";
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
// singular value, C being scaled to the size 1, is the margin. Where C is proved to be definite there is no such mu.
Condition stabilizable(const ScaledSystem& scaled) {
  Condition condition{"stabilizable", true, std::numeric_limits<double>::infinity(), ""};
  const MatrixXd& unscaled = scaled.system.machine.damping;
  if (positive_definite(unscaled) == Proof::holds) return condition;
  const double scale = std::max(unscaled.norm(), std::numeric_limits<double>::min());
  const MatrixXd damping = unscaled / scale, directions = acted_on(scaled.system);
  for (const std::complex<double> mu : dense::general_eigen(damping).values) {
    if (mu.real() > rounding) continue;
    const MatrixXd hautus = hautus_matrix(damping, mu, directions);
    const double least = dense::least_singular_value(hautus);
    if (!(least < condition.margin)) continue;
    condition.margin = least;
    condition.reason = "the direction " + direction_text(scaled.direction(least_direction(hautus))) +
                       " has the damping " + to_text(mu.real() * scale) +
                       " N s/m per kg, and neither friction nor an actuator acts on it: add one of them";
  }
  condition.holds = condition.margin > rounding;
  if (condition.holds) condition.reason.clear();
  return condition;
}

// certify_attractivity() asks the same of K. Of C it takes the symmetric part. The margin is 1 less the greatest skew
// part over the rounding of decimal numbers.
Condition symmetry(const char* name, const MatrixXd& matrix) {
  const auto skew = (matrix - matrix.transpose()).cwiseAbs().array();
  const auto size = matrix.cwiseAbs().cwiseMax(matrix.transpose().cwiseAbs()).array();
  const double share = (skew > 0).select(skew / (entry_rounding * size), 0).maxCoeff();
  Condition condition{name, symmetric(matrix), 1 - share, ""};
  if (!condition.holds)
    condition.reason = "entries differ by up to " + to_text(largest(skew_part(matrix))) + " across the diagonal";
  return condition;
}

Condition positive_stiffness(const MatrixXd& stiffness) {
  const bool holds = symmetric(stiffness) && positive_definite(stiffness) == Proof::holds;
  const double margin = definiteness(dense::symmetric_part(stiffness));
  return {"K_cl positive definite", holds,
          holds ? std::max(margin, std::numeric_limits<double>::min()) : std::min(margin, 0.0),
          holds ? "" : "its least eigenvalue is not proved to be positive: add feedback of position"};
}

// In mass units, as certify_attractivity() asks it.
Condition unstable_columns_in_span(const LinearMachine<>& closed_loop) {
  Condition span{"eigencolumns in span W", true, std::numeric_limits<double>::infinity(), ""};
  const ScaledSystem scaled = in_mass_units({closed_loop, MatrixXd(closed_loop.coordinates(), 0)});
  const LinearMachine<>& machine = scaled.system.machine;
  if (positive_definite(machine.damping) == Proof::holds) return span;
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(dense::symmetric_part(machine.damping));
  const MatrixXd complement = spanned_space(acting_directions(machine)).complement;
  const double zero = 1e-15 * static_cast<double>(complement.rows()) * machine.damping.norm();
  for (Index i = 0; i < complement.rows() && eigen.values[i] <= zero; ++i) {
    const double outside = (complement.transpose() * eigen.vectors.col(i)).norm();
    span.margin = std::min(span.margin, 1e-9 - outside);
    if (span.margin >= 0) continue;
    span.holds = false;
    span.reason = "the direction " + direction_text(scaled.direction(eigen.vectors.col(i))) + " with the damping " +
                  to_text(eigen.values[i]) + " N s/m per kg is not a sum of friction directions: damp it by feedback";
  }
  return span;
}

}  // namespace

LinearMachine<> closed_loop(const ActuatedSystem& system, const PdGains& gains) {
  return with_feedback(system.machine, system.actuators, gains.position_N_per_m, gains.velocity_Ns_per_m);
}

std::vector<Condition> machine_conditions(const ActuatedSystem& system) {
  const ScaledSystem scaled = in_mass_units(system);
  const MatrixXd z = Actuation{scaled.system.actuators}.unreached;
  return {unreached_symmetric("stiffness_symmetric", z, scaled.system.machine.stiffness),
          unreached_stiffness_positive(scaled, z),
          unreached_symmetric("damping_symmetric", z, scaled.system.machine.damping), stabilizable(scaled)};
}

std::vector<Condition> loop_conditions(const LinearMachine<>& closed_loop) {
  return {symmetry("K_cl symmetric", closed_loop.stiffness), positive_stiffness(closed_loop.stiffness),
          unstable_columns_in_span(closed_loop), symmetry("C_cl symmetric", closed_loop.damping)};
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
