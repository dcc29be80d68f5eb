// The corners of { sum_j s_j g_j : |s_j| <= 1 }, as the signs that lead to them.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <set>
#include <vector>

#include "breakaway/stability/equilibrium_set.hpp"

namespace breakaway::stability {

using Signs = std::vector<std::int8_t>;  // of each generator; 0 for one that is 0

// An upper bound of the work of vertex_signs(): corners looked at.
double vertex_candidates(const Eigen::MatrixXd& generators);

// Returns a sign vector for each corner. On a facet with the normal u every generator that is not orthogonal to u has
// the sign of g . u, and the others make a smaller zonotope; independent generators make a parallelepiped, of which all
// signs are corners.
std::set<Signs> vertex_signs(const Eigen::MatrixXd& generators);

// Returns the corners of a zonotope in the plane, counter-clockwise. Two make a segment, one a point.
Polygon zonogon(const Eigen::Matrix2Xd& generators);

}  // namespace breakaway::stability
