// The zonotope { sum_j s_j g_j : |s_j| <= 1 } of generators g_j, inside the space that they span.
//
// Its support function is h(u) = sum_j |u . g_j|, and each facet is orthogonal to a u that is orthogonal to r - 1
// independent generators, r being their rank. The same u are the corners of { u : h(u) <= 1 }, over which a convex
// function is greatest at a corner: both the equilibrium set (4) and the linear program (9) of [A] are this list.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace breakaway::stability {

struct SpannedSpace {
  Eigen::MatrixXd basis;       // n x r, orthonormal
  Eigen::MatrixXd complement;  // n x (n - r), orthonormal
  Eigen::MatrixXd generators;  // r x k: those that are not zero, of unit length, in the coordinates of `basis`
};

// Generators whose directions are closer than 1e-12 count as one direction.
SpannedSpace spanned_space(const Eigen::MatrixXd& generators);

// Returns how many subsets facet_directions() would look at, which is C(k, r - 1).
double facet_candidates(const SpannedSpace& space);

constexpr double most_facet_candidates = 1e6;  // about a second

// Calls `visit` with a unit vector of R^n, in the spanned space, for every facet (one of each opposite pair, some of
// them more than once).
void facet_directions(const SpannedSpace& space, const std::function<void(const Eigen::VectorXd&)>& visit);

// The corners v of { v in the spanned space : h(v) <= 1 }, one of each opposite pair: n x how many. `pushes` are the
// generators as they were given to spanned_space().
Eigen::MatrixXd unit_corners(const SpannedSpace& space, const Eigen::MatrixXd& pushes);

}  // namespace breakaway::stability
