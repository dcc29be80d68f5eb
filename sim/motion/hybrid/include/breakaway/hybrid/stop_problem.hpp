// The problem of a stop: some directions have lost their speed at one instant. Which of them stick, and which slide on?
//
// The accelerations gamma = G lambda + b depend on the friction forces lambda, and friction opposes sliding:
//   gamma_i = 0 with -forward_i <= lambda_i <= backward_i, or gamma_i > 0 with lambda_i = -forward_i,
//   or gamma_i < 0 with lambda_i = backward_i.
// With lambda = forward (z1 - 1) and gamma = w1 - z2 this is a linear complementarity problem of twice the size. Each
// row and each force is taken in its own unit, so that no scale of length, mass or force matters.
//
// The solution is checked. Lemke's method says which directions stick and which slide either way; of a residual in his
// table nothing is believed. The forces that hold what sticks are solved for again, each sum comes with a bound of its
// rounding, and these conditions are put to what has come out. Friction is monotone, so the accelerations are unique,
// and a solution that passes is the one.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "breakaway/hybrid/stick_set.hpp"

namespace breakaway::hybrid {

// These hold an entry for each stopped direction, or for each pair, and lie on the stack.
template <class Scalar>
using Directional = Eigen::Matrix<Scalar, Eigen::Dynamic, 1, Eigen::ColMajor, most_directions, 1>;
template <class Scalar>
using DirectionalPairs =
    Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_directions, most_directions>;
using DirectionVector = Directional<double>;

// Scalar: double, or long double where that cannot decide.
template <class Scalar>
struct StopProblem {
  DirectionalPairs<Scalar> coupling;  // G = W^T M^-1 W of the stopped directions, with a positive diagonal
  Directional<Scalar> acceleration;   // b: without friction in these directions
  Directional<Scalar> rounding;       // of b, >= 0, if what it is made of was rounded
  Directional<Scalar> forward_N;      // > 0: friction against sliding forwards,
  Directional<Scalar> backward_N;     // and against sliding backwards

  explicit StopProblem(Eigen::Index count)
      : coupling(count, count), acceleration(count), rounding(count), forward_N(count), backward_N(count) {}
};

struct Sliding {
  DirectionVector signs;    // of each direction's acceleration, which is that of its sliding; 0 where it sticks
  DirectionVector force_N;  // lambda
  DirectionSet ties = 0;    // bit i: i has an acceleration that its `rounding` may have made of zero
};

// Returns nothing where rounding in this precision leaves the solution in doubt.
template <class Scalar>
std::optional<Sliding> sliding_after_stop(const StopProblem<Scalar>& problem);

extern template std::optional<Sliding> sliding_after_stop(const StopProblem<double>&);
extern template std::optional<Sliding> sliding_after_stop(const StopProblem<long double>&);

}  // namespace breakaway::hybrid
