// The problem of a stop: some directions have lost their speed at one instant. Which of them stick, and which slide on?
//
// The accelerations gamma = G lambda + b depend on the friction forces lambda, and friction opposes sliding:
//   gamma_i = 0 with -forward_i <= lambda_i <= backward_i, or gamma_i > 0 with lambda_i = -forward_i,
//   or gamma_i < 0 with lambda_i = backward_i.
// With lambda = forward (z1 - 1) and gamma = w1 - z2 this is a linear complementarity problem of twice the size. Each
// row and each force is taken in its own unit, so that no scale of length, mass or force matters.
#pragma once

#include <Eigen/Core>

#include "breakaway/hybrid/stick_set.hpp"

namespace breakaway::hybrid {

// These hold an entry for each stopped direction, or for each pair, and lie on the stack.
using DirectionVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, most_directions, 1>;
using DirectionMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_directions, most_directions>;

struct StopProblem {
  DirectionMatrix coupling;      // G = W^T M^-1 W of the stopped directions, with a positive diagonal
  DirectionVector acceleration;  // b: without friction in these directions
  DirectionVector forward_N;     // > 0: friction against sliding forwards,
  DirectionVector backward_N;    // and against sliding backwards
};

// The sign of each direction's acceleration, which is that of its sliding; 0 where it sticks. Throws InputError for
// directions and a mass so ill-scaled that no friction forces can be found.
DirectionVector sliding_after_stop(const StopProblem& problem);

}  // namespace breakaway::hybrid
