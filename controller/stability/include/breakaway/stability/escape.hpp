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
// (q, q'). What rounding may have made of z is at most 1e-12 of the length of (q, q') in the unit of each entry.
struct EscapeLevel {
  Eigen::VectorXd real, imaginary;  // w, 2n each
  Eigen::VectorXd unit;             // of (q, q'), entry by entry: masses, springs and w are of the size 1 in it
  double growth_rate;               // s_r > 0 [1/s]
  double level;                     // b / s_r, rounded up
};

// Returns the levels of the modes that grow, the fastest first, by more than 1e-12 of their frequency and by more than
// rounding can tell from standing still, whatever units the machine is written in; none for a stable machine. The proof
// is in exact arithmetic; levels carry a margin of 1e-9 for the rounding of s and of 1e-12 for that of w. A mode that
// rounding leaves less certain, next to a defective eigenvalue or of a mass matrix that is singular to 25 digits, has
// no level.
std::vector<EscapeLevel> escape_levels(const LinearMachine<>& system);

}  // namespace breakaway::stability
