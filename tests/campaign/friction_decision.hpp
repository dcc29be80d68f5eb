// Which directions stick and which slide, by Gauss' principle of least constraint: of all that friction can do, it does
// what leaves the least acceleration in the norm of the mass. That is the projection of the applied force on a
// zonotope, a least-squares problem with bounds, and it decides uniquely however many directions depend on one another.
// Where a direction stays at its very limit without acceleration, the same is asked of the jerk, with the cone of the
// directions in which friction can still change; and so on.
#pragma once

#include <vector>

#include "dense_algebra.hpp"

namespace breakaway::campaign {

// The machine in coordinates x = L^T q, where the mass L L^T is the identity. Directions without friction are left out,
// and each of the others is multiplied by its friction, so that all friction forces lie in [-1, 1].
template <class Real>
struct NormalMachine {
  Matrix<Real> stiffness, damping;
  std::vector<Vector<Real>> pushes;  // L^-1 w_i p_i
  Vector<Real> force;                // L^-1 f
  Real rate = 0;                     // an upper bound of how fast anything changes [1/s]
};

// Says how the directions go on: 0 sticks, +-1 slides that way. `signs` are the given ones where a direction slides,
// and decided here where it is `stopped`. False if the problem could not be solved.
template <class Real>
bool decide_friction(const NormalMachine<Real>& machine, const Vector<Real>& q, const Vector<Real>& v,
                     const std::vector<bool>& stopped, std::vector<int>& signs);

}  // namespace breakaway::campaign
