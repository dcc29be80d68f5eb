// Extrapolation of the linearly implicit Euler rule with 1, 2, .. 10 substeps (Deuflhard; SEULEX of Hairer and Wanner,
// Solving Ordinary Differential Equations II, section IV.9): for equations with a part that relaxes far faster than the
// step, which the explicit rule of gragg_bulirsch_stoer.hpp would follow with micro-steps.
//
// As there, the tableau holds increments, so that a step from zero keeps its relative accuracy.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "breakaway/motion/gragg_bulirsch_stoer.hpp"

namespace breakaway::motion {

// Row by row.
template <std::size_t N>
using Matrix = std::array<Vector<N>, N>;

// LU factors with partial pivoting, of a matrix that is not singular.
template <std::size_t N>
class SmallLu {
 public:
  explicit SmallLu(const Matrix<N>& matrix) : lu_{matrix} {
    for (std::size_t k = 0; k < N; ++k) {
      pivot_[k] = k;
      for (std::size_t i = k + 1; i < N; ++i)
        if (std::abs(lu_[i][k]) > std::abs(lu_[pivot_[k]][k])) pivot_[k] = i;
      std::swap(lu_[k], lu_[pivot_[k]]);
      for (std::size_t i = k + 1; i < N; ++i) {
        lu_[i][k] /= lu_[k][k];
        for (std::size_t j = k + 1; j < N; ++j) lu_[i][j] -= lu_[i][k] * lu_[k][j];
      }
    }
  }

  void solve(Vector<N>& b) const {
    for (std::size_t k = 0; k < N; ++k) std::swap(b[k], b[pivot_[k]]);
    for (std::size_t i = 1; i < N; ++i)
      for (std::size_t j = 0; j < i; ++j) b[i] -= lu_[i][j] * b[j];
    for (std::size_t i = N; i-- > 0;) {
      for (std::size_t j = i + 1; j < N; ++j) b[i] -= lu_[i][j] * b[j];
      b[i] /= lu_[i][i];
    }
  }

 private:
  Matrix<N> lu_;
  std::array<std::size_t, N> pivot_{};
};

namespace detail {

inline constexpr std::size_t implicit_rows = 10;

template <std::size_t N, class RightHandSide>
Vector<N> implicit_increment(RightHandSide& slope, const Matrix<N>& jacobian, double t, const Vector<N>& y, double step,
                             std::size_t parts) {
  const double h = step / static_cast<double>(parts);
  Matrix<N> matrix;
  for (std::size_t i = 0; i < N; ++i)
    for (std::size_t j = 0; j < N; ++j) matrix[i][j] = (i == j ? 1.0 : 0.0) - h * jacobian[i][j];
  const SmallLu<N> lu{matrix};
  Vector<N> moved{}, change{};
  for (std::size_t part = 1; part <= parts; ++part) {
    slope(t + static_cast<double>(part) * h, sum(y, moved), change);
    for (double& value : change) value *= h;
    lu.solve(change);
    moved = sum(moved, change);
  }
  return moved;
}

// Adds a row to the tableau in place and returns how far its best value lies from that of the row before.
template <std::size_t N>
Vector<N> extrapolate_implicit(std::array<Vector<N>, implicit_rows>& tableau, const Vector<N>& increment,
                               std::size_t row) {
  Vector<N> value = increment, change = increment;
  const Vector<N> before = row > 0 ? tableau[row - 1] : Vector<N>{};
  for (std::size_t column = 0; column < row; ++column) {
    const double ratio = static_cast<double>(row + 1) / static_cast<double>(row - column);
    for (std::size_t i = 0; i < N; ++i) {
      const double correction = (value[i] - tableau[column][i]) / (ratio - 1);
      tableau[column][i] = value[i];
      value[i] += correction;
    }
  }
  tableau[row] = value;
  for (std::size_t i = 0; i < N; ++i) change[i] = value[i] - before[i];
  return change;
}

}  // namespace detail

// Takes one step of y' = slope(t, y) as extrapolated_step() does. `jacobian` is the derivative of the right-hand side
// by y at (t, y); what it leaves out costs steps and no accuracy. A component's error may reach its `floor` (> 0).
template <std::size_t N, class RightHandSide>
ExtrapolatedStep<Vector<N>> linearly_implicit_step(RightHandSide&& slope, const Matrix<N>& jacobian, double t,
                                                   const Vector<N>& y, double step, const Vector<N>& floor) {
  std::array<Vector<N>, detail::implicit_rows> tableau;
  ExtrapolatedStep<Vector<N>> result;
  double best_work = 0, evaluations = 0;
  for (std::size_t row = 0; row < detail::implicit_rows; ++row) {
    const auto increment = detail::implicit_increment<N>(slope, jacobian, t, y, step, row + 1);
    const auto change = detail::extrapolate_implicit<N>(tableau, increment, row);
    evaluations += static_cast<double>(row + 2);
    if (row < 2) continue;
    double error = 0;
    for (std::size_t i = 0; i < N; ++i) error = std::max(error, std::abs(change[i]) / floor[i]);
    result.state = detail::sum(y, tableau[row]);
    if (!std::isfinite(error)) {
      result.suggested_step = 0.1 * step;
      return result;
    }
    const double exponent = 1 / static_cast<double>(row + 1);
    const double factor = std::clamp(0.94 * std::pow(0.65 / std::max(error, 1e-30), exponent), 0.05, 8.0);
    if (row == 2 || evaluations / factor < best_work) {
      best_work = evaluations / factor;
      result.suggested_step = step * factor;
    }
    if (error <= 1) {
      // Where the last row is the cheapest so far, the next one may be cheaper still: the longer step lets it show.
      const bool try_higher = evaluations / factor == best_work && row + 1 < detail::implicit_rows;
      if (try_higher) result.suggested_step *= (evaluations + static_cast<double>(row + 3)) / evaluations;
      result.converged = true;
      return result;
    }
  }
  result.suggested_step = std::min(result.suggested_step, 0.7 * step);
  return result;
}

}  // namespace breakaway::motion
