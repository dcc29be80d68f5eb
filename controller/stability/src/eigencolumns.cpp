#include "eigencolumns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "breakaway/stability/dense.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Multiplications, a second or two on a PC, for a basis of a machine with ever so many corners: it is valid as it is.
constexpr double most_work = 2e9;

// alpha max |lambda_i| |M^-1/2 U_i|, and alpha alone when all eigenvalues are 0: what is to be made small.
double cost(const MatrixXd& columns, const VectorXd& values, const MatrixXd& inverse_mass, const MatrixXd& corners) {
  const double alpha = (columns.transpose() * corners).cwiseAbs().colwise().sum().maxCoeff();
  if ((values.array() == 0).all()) return alpha;
  double largest = 0;
  for (Index i = 0; i < columns.cols(); ++i) {
    const double mobility = columns.col(i).dot(inverse_mass * columns.col(i));
    largest = std::max(largest, std::abs(values[i]) * std::sqrt(mobility));
  }
  return alpha * largest;
}

constexpr int samples = 24, refinements = 40;
constexpr double costs_of_a_turn = samples + 2 * refinements + 2;

// The least of f on [0, pi/2) as far as `samples` can tell, then by golden section.
template <class Function>
double best_angle(const Function& f) {
  constexpr double step = std::numbers::pi / 2 / samples, golden = std::numbers::phi - 1;
  int best = 0;
  double least = f(0);
  for (int i = 1; i < samples; ++i) {
    if (const double value = f(i * step); value < least) least = value, best = i;
  }
  double low = (best - 1) * step, high = (best + 1) * step;
  for (int i = 0; i < refinements; ++i) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    const bool is_left = f(left) < f(right);
    (is_left ? high : low) = is_left ? right : left;
  }
  return (low + high) / 2;
}

MatrixXd turned(MatrixXd columns, Index i, Index j, double angle) {
  const VectorXd first = columns.col(i), second = columns.col(j);
  columns.col(i) = std::cos(angle) * first + std::sin(angle) * second;
  columns.col(j) = std::cos(angle) * second - std::sin(angle) * first;
  return columns;
}

// The basis within equal eigenvalues that diagonalises `form`: rounding chose the one that is given, and what is found
// from there would depend on the units that the machine is written in.
MatrixXd diagonalising(MatrixXd columns, const VectorXd& values, const MatrixXd& form) {
  for (Index first = 0, next = 0; first < values.size(); first = next) {
    while (next < values.size() && values[next] == values[first]) ++next;
    auto group = columns.middleCols(first, next - first);
    if (group.cols() == 1) continue;
    group = (group * dense::symmetric_eigen(dense::symmetric_part(group.transpose() * form * group)).vectors).eval();
    for (auto column : group.colwise()) {
      Index largest = 0;
      column.cwiseAbs().maxCoeff(&largest);
      if (column[largest] < 0) column = -column;
    }
  }
  return columns;
}

// Turns two columns of equal eigenvalues at a time, as long as it lowers the cost, and so often at most.
template <class Cost>
MatrixXd descend(MatrixXd columns, const VectorXd& values, const Cost& cost_of, double most_turns) {
  constexpr int most_sweeps = 8;
  double least = cost_of(columns);
  bool improved = true;
  for (int sweep = 0; improved && sweep < most_sweeps; ++sweep) {
    improved = false;
    for (Index i = 0; i < values.size(); ++i) {
      for (Index j = i + 1; j < values.size() && values[j] == values[i]; ++j) {
        if (--most_turns < 0) return columns;
        const double angle = best_angle([&](double a) { return cost_of(turned(columns, i, j, a)); });
        const MatrixXd better = turned(columns, i, j, angle);
        if (!(cost_of(better) < (1 - 1e-12) * least)) continue;
        columns = better;
        least = cost_of(better);
        improved = true;
      }
    }
  }
  return columns;
}

}  // namespace

Eigencolumns eigencolumns(const MatrixXd& damping, Proof definite, Proof semidefinite) {
  const dense::SymmetricEigen eigen = dense::symmetric_eigen(damping);
  Eigencolumns basis{eigen.vectors, eigen.values};
  const double rounding = 1e-15 * static_cast<double>(damping.rows()) * damping.norm();
  for (Index i = 0; i < basis.values.size(); ++i) {
    double& value = basis.values[i];
    if (definite == Proof::holds) {
      value = std::max(value, std::numeric_limits<double>::min());
    } else if (semidefinite == Proof::holds) {
      if (value <= rounding) value = 0;
    } else if (std::abs(value) <= rounding) {
      value = -rounding;
    }
    if (i > 0 && value - basis.values[i - 1] <= 4 * rounding) value = basis.values[i - 1];
  }
  return basis;
}

void turn_for_level(Eigencolumns& basis, Index unstable, const MatrixXd& inverse_mass, const MatrixXd& corners) {
  const VectorXd values = basis.values.head(unstable);
  const MatrixXd columns = basis.columns.leftCols(unstable);
  if (std::adjacent_find(values.begin(), values.end()) == values.end()) return;
  const auto cost_of = [&](const MatrixXd& choice) { return cost(choice, values, inverse_mass, corners); };
  const double most_turns = most_work / (costs_of_a_turn * static_cast<double>(corners.size() * columns.cols()));
  double least = std::numeric_limits<double>::infinity();
  for (const MatrixXd& form : {inverse_mass, MatrixXd{corners * corners.transpose()}}) {
    const MatrixXd found = descend(diagonalising(columns, values, form), values, cost_of, most_turns);
    if (const double value = cost_of(found); value < least) {
      least = value;
      basis.columns.leftCols(unstable) = found;
    }
  }
}

}  // namespace breakaway::stability
