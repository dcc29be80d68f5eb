// Gragg-Bulirsch-Stoer extrapolation: the modified midpoint rule with 2, 4, .. 18 substeps, extrapolated in the square
// of the substep. Order up to 18, for smooth right-hand sides of a few equations.
//
// The tableau holds increments, not states, so that a step from zero keeps its relative accuracy however small it is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "breakaway/input/input_error.hpp"

namespace breakaway::motion {

template <std::size_t N>
using Vector = std::array<double, N>;

// State: a Vector, or any other vector with size(), [] and iterators, as Eigen's of dynamic size.
template <class State>
struct ExtrapolatedStep {
  bool converged = false;
  State state{};              // at the end of the step, if it converged
  double suggested_step = 0;  // to go on with, or to retry with; signed like the step
};

namespace detail {

inline constexpr std::size_t max_rows = 9;

constexpr double substeps(std::size_t row) { return 2.0 * static_cast<double>(row + 1); }

// Right-hand sides evaluated for rows 0..row: 2 + 4 + .. + 2 (row + 1).
constexpr double evaluations(std::size_t row) { return static_cast<double>((row + 1) * (row + 2)); }

// The type of an index.
template <class State>
using Place = decltype(State{}.size());

template <class State>
State zeros(State of_this_size) {
  std::fill(of_this_size.begin(), of_this_size.end(), 0.0);
  return of_this_size;
}

template <class State>
State sum(State a, const State& b) {
  for (Place<State> i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

// The increment over one step by the modified midpoint rule; slope0 is the right-hand side at the start.
template <class State, class RightHandSide>
State midpoint_increment(RightHandSide& slope, double t, const State& y, const State& slope0, double step,
                         double parts) {
  const double h = step / parts;
  State before = zeros(y), now = slope0, derivative = slope0;
  for (double& increment : now) increment *= h;
  for (double part = 1; part < parts; ++part) {
    slope(t + part * h, sum(y, now), derivative);
    for (Place<State> i = 0; i < y.size(); ++i) {
      const double next = before[i] + 2 * h * derivative[i];
      before[i] = now[i];
      now[i] = next;
    }
  }
  return now;
}

// Adds a row to the tableau in place (Neville) and returns how far its best value lies from that of the row before.
// Beyond the stability of the midpoint rule the last column alone would change too little: it is divided by up to 80.
template <class State>
State extrapolate(std::array<State, max_rows>& tableau, const State& increment, std::size_t row) {
  const State before = row > 0 ? tableau[row - 1] : zeros(increment);
  State value = increment, change = increment;
  for (std::size_t column = 0; column < row; ++column) {
    const double ratio = substeps(row) / substeps(row - column - 1);
    for (Place<State> i = 0; i < value.size(); ++i) {
      const double correction = (value[i] - tableau[column][i]) / (ratio * ratio - 1);
      tableau[column][i] = value[i];
      value[i] += correction;
    }
  }
  tableau[row] = value;
  for (Place<State> i = 0; i < value.size(); ++i) change[i] = value[i] - before[i];
  return change;
}

}  // namespace detail

// Takes one step of y' = slope(t, y), which is called as slope(t, y, derivative), from (t, y). A component's error may
// reach tolerance times the greater of its magnitudes at the two ends, plus its `floor`: what rounding inside the
// right-hand side makes of the step. A tolerance of 1e-14 is attainable.
template <class State, class RightHandSide>
ExtrapolatedStep<State> extrapolated_step(RightHandSide&& slope, double t, const State& y, double step,
                                          double tolerance, const std::type_identity_t<State>& floor) {
  State slope0 = y;
  slope(t, y, slope0);
  std::array<State, detail::max_rows> tableau;
  ExtrapolatedStep<State> result;
  double best_work = 0;
  for (std::size_t row = 0; row < detail::max_rows; ++row) {
    const auto increment = detail::midpoint_increment(slope, t, y, slope0, step, detail::substeps(row));
    const auto change = detail::extrapolate(tableau, increment, row);
    if (row < 2) continue;
    result.state = detail::sum(y, tableau[row]);
    double error = 0;
    for (detail::Place<State> i = 0; i < y.size(); ++i) {
      const double scale = floor[i] + tolerance * std::max(std::abs(y[i]), std::abs(result.state[i]));
      if (change[i] != 0) error = std::max(error, std::abs(change[i]) / scale);
      if (!std::isfinite(result.state[i])) error = std::numeric_limits<double>::infinity();
    }
    if (!std::isfinite(error)) {
      result.suggested_step = 0.1 * step;
      return result;
    }
    // The step at which this row would just converge, and the row whose work per unit of step is least.
    const double exponent = 1 / static_cast<double>(2 * row + 1);  // the row before is of order 2 row
    const double factor = std::clamp(0.94 * std::pow(0.65 / std::max(error, 1e-30), exponent), 0.05, 8.0);
    const double work = detail::evaluations(row) / factor;
    if (row == 2 || work < best_work) {
      best_work = work;
      result.suggested_step = step * factor;
    }
    if (error <= 1) {
      // Where the last row is the cheapest so far, the next one may be cheaper still: the longer step lets it show.
      const bool try_higher = work == best_work && row + 1 < detail::max_rows;
      if (try_higher) result.suggested_step *= detail::evaluations(row + 1) / detail::evaluations(row);
      result.converged = true;
      return result;
    }
  }
  result.suggested_step = std::copysign(std::min(std::abs(result.suggested_step), 0.7 * std::abs(step)), step);
  return result;
}

template <class State, class RightHandSide>
ExtrapolatedStep<State> extrapolated_step(RightHandSide&& slope, double t, const State& y, double step,
                                          double tolerance) {
  return extrapolated_step(slope, t, y, step, tolerance, detail::zeros(y));
}

template <class State>
struct Integration {
  State state{};
  int steps = 0;
};

// Integrates from t to exactly `end` with adaptive steps, the first of which is at most first_step (positive). Throws
// InputError when the step falls below the resolution of t.
template <class State, class RightHandSide>
Integration<State> integrate(RightHandSide&& slope, double t, const State& y, double end, double first_step,
                             double tolerance) {
  Integration<State> result{y, 0};
  double step = std::copysign(first_step, end - t);
  while (t != end) {
    const bool last = std::abs(step) >= std::abs(end - t);
    if (last) step = end - t;
    const auto trial = extrapolated_step(slope, t, result.state, step, tolerance);
    if (trial.converged) {
      t = last ? end : t + step;
      result.state = trial.state;
      ++result.steps;
    } else if (t + trial.suggested_step == t) {
      throw InputError{"the integration cannot go on: its step fell below the resolution of its variable"};
    }
    step = trial.suggested_step;
  }
  return result;
}

}  // namespace breakaway::motion
