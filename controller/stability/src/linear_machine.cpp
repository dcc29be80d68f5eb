#include "breakaway/stability/linear_machine.hpp"

#include <cmath>
#include <string>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/double_double.hpp"
#include "infinite.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void require_size(const char* name, const MatrixXd& matrix, Index rows, Index columns) {
  if (matrix.rows() == rows && matrix.cols() == columns) return;
  throw InputError{name, "is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) + ": make it " +
                             std::to_string(rows) + " x " + std::to_string(columns) + ", to fit mass and directions"};
}

void require_finite(const char* name, const MatrixXd& matrix) {
  if (!matrix.allFinite()) throw InputError{name, "has an entry that is not a finite number: correct it"};
}

constexpr double decimal_rounding = 0x1p-53;  // of a number in a file, relative to it

// A sum of numbers and products in double, and the sum of the absolute errors of all its operations, which is 0 where
// all of them were exact.
struct TrackedSum {
  double value = 0, error = 0;

  void add(double term) {
    const DoubleDouble sum = DoubleDouble{value} + term;
    value = sum.high();
    error += std::abs(sum.low());
  }
  void add_product(double a, double b) {
    const DoubleDouble product = DoubleDouble{a} * b;
    error += std::abs(product.low());
    add(product.high());
  }
};

// Less a diagonal D with v^T D v >= |v|^T E |v| for all v. 2 v_i v_j is at most w v_i^2 + v_j^2 / w for any w > 0, and
// of the sizes of the diagonal entries it is the one that no unit changes.
MatrixXd less_greatest_forms(MatrixXd matrix, const MatrixXd& error, const VectorXd& size) {
  constexpr double bound = 1 + 0x1p-40;  // of the rounding of all this
  for (Index i = 0; i < matrix.rows(); ++i) {
    double taken = 2 * error(i, i);
    for (Index j = 0; j < matrix.rows(); ++j) {
      const double both = error(i, j) + error(j, i), w = std::sqrt(size[i] / size[j]);
      if (i != j && both != 0) taken += both * (w > 0 && std::isfinite(w) ? w : 1);
    }
    if (taken != 0) matrix(i, i) = std::nextafter(matrix(i, i) - bound / 2 * taken, -infinite);
  }
  return matrix;
}

// A + S F, of which entries across the diagonal are made equal where only rounding keeps them apart. What rounding may
// have added to any v^T (A + S F) v is taken off again: a gain that is large against A would round away what no
// actuator reaches, and a certificate of the rest would be wrong.
MatrixXd with_product(const MatrixXd& open, const MatrixXd& actuators, const MatrixXd& gain) {
  const MatrixXd fed = actuators.cwiseAbs() * gain.cwiseAbs();
  const MatrixXd rounding = static_cast<double>(actuators.cols() + 8) * decimal_rounding * (open.cwiseAbs() + fed);
  MatrixXd closed = open, error = MatrixXd::Zero(open.rows(), open.cols());
  for (Index i = 0; i < closed.rows(); ++i) {
    for (Index j = 0; j < closed.cols(); ++j) {
      TrackedSum sum{open(i, j)};
      for (Index k = 0; k < actuators.cols(); ++k) sum.add_product(actuators(i, k), gain(k, j));
      closed(i, j) = sum.value;
      error(i, j) = sum.error;
    }
  }
  for (Index i = 0; i < closed.rows(); ++i) {
    for (Index j = 0; j < i; ++j) {
      if (fed(i, j) + fed(j, i) == 0) continue;
      const double apart = std::abs(closed(i, j) - closed(j, i));
      if (!(apart <= rounding(i, j) + rounding(j, i))) continue;
      error(i, j) += apart;
      closed(i, j) = closed(j, i) = (closed(i, j) + closed(j, i)) / 2;
    }
  }
  return less_greatest_forms(closed, error, open.diagonal().cwiseAbs() + fed.diagonal());
}

// D A D, where D scales lengths and masses.
MatrixXd with_unit_diagonal(const MatrixXd& matrix) {
  const VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * matrix * scale.asDiagonal();
}

void require_positive_mass(const MatrixXd& mass) {
  if (mass != mass.transpose()) throw InputError{"mass", "is not symmetric: use (M + M^T) / 2, the matrix of v^T M v"};
  if ((mass.diagonal().array() > 0).all() && dense::Cholesky(with_unit_diagonal(mass)).succeeded()) return;
  throw InputError{"mass", "is not positive definite: give every coordinate a mass of its own, or drop it"};
}

}  // namespace

bool symmetric(const MatrixXd& matrix) {
  const auto entries = matrix.cwiseAbs().cwiseMax(matrix.transpose().cwiseAbs());
  return ((matrix - matrix.transpose()).cwiseAbs().array() <= 2 * decimal_rounding * entries.array()).all();
}

double definiteness(const MatrixXd& matrix) {
  if (const double least = matrix.diagonal().minCoeff(); !(least > 0)) return least;
  return dense::symmetric_eigenvalues(with_unit_diagonal(matrix))[0];
}

LinearMachine<> with_feedback(LinearMachine<> machine, const MatrixXd& actuators, const MatrixXd& position_gain,
                              const MatrixXd& velocity_gain) {
  machine.stiffness = with_product(machine.stiffness, actuators, position_gain);
  machine.damping = with_product(machine.damping, actuators, velocity_gain);
  return machine;
}

void require_valid_statics(const LinearMachine<>& machine) {
  const Index n = machine.stiffness.rows(), m = machine.directions.cols();
  if (n == 0) throw InputError{"stiffness", "is empty: give a machine at least one coordinate"};
  require_size("stiffness", machine.stiffness, n, n);
  require_size("directions", machine.directions, n, m);
  require_size("friction_N", machine.friction_N, m, 1);
  require_finite("stiffness", machine.stiffness);
  require_finite("directions", machine.directions);
  require_finite("friction_N", machine.friction_N);
  for (Index i = 0; i < m; ++i) {
    if (machine.friction_N[i] >= 0) continue;
    throw InputError{"friction_N[" + std::to_string(i) + "]",
                     "is " + to_text(machine.friction_N[i]) + ": give the magnitude mu |lambda_N| >= 0"};
  }
}

void require_well_formed(const LinearMachine<>& machine) {
  const Index n = machine.mass.rows();
  if (n == 0) throw InputError{"mass", "is empty: give a machine at least one coordinate"};
  require_size("mass", machine.mass, n, n);
  require_size("damping", machine.damping, n, n);
  require_size("stiffness", machine.stiffness, n, n);
  require_size("force_N", machine.force_N, machine.force_N.size() == 0 ? 0 : n, 1);
  require_finite("mass", machine.mass);
  require_finite("damping", machine.damping);
  require_finite("force_N", machine.force_N);
  require_valid_statics(machine);
}

void require_valid(const LinearMachine<>& machine) {
  require_well_formed(machine);
  require_positive_mass(machine.mass);
}

}  // namespace breakaway::stability
