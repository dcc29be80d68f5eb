// Escape: levels beyond which an unstable machine can never come to rest, whatever its friction does.
//
// With x = (q, q') the machine is x' = A x + B lambda, |lambda_i| <= p_i. For an eigenvalue s of A with s_r = Re s > 0
// and its left eigenvector w, z = w^T x obeys z' = s z + w^T B lambda. Friction is bounded, so |w^T B lambda| <= b and
//   d|z|/dt >= s_r |z| - b:
// once |z| > b / s_r, it grows for ever, at least as e^(s_r t) in the end. Every state of rest has z' = 0, so
// |z| <= b / |s| <= b / s_r there: such a motion never rests. For real s the level cannot be lowered.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

// An EscapeLevel stands for one unstable mode. Every state with |z| > level is lost, where z = (real + i imaginary) .
// (q, q').
struct EscapeLevel {
  Eigen::VectorXd real, imaginary;  // w, 2n each, |w| = 1
  double growth_rate;               // s_r > 0 [1/s]
  double level;                     // b / s_r, rounded up
};

// Returns the levels of all modes that grow faster than rounding can tell from standing still; none for a stable
// machine. The proof is in exact arithmetic; levels carry a margin of 1e-9 for the rounding of w and s.
std::vector<EscapeLevel> escape_levels(const LinearMachine<>& system);

}  // namespace breakaway::stability
