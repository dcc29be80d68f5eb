// What depends on the set of sticking directions alone: the motions that are left, and the load on what sticks.
#pragma once

#include <cstdint>
#include <vector>

#include "friction_decision.hpp"
#include "mode_flow.hpp"

namespace breakaway::campaign {

// e = (omega w, w') in coordinates w of the velocities that are left, v = free w.
template <class Real>
struct StickMode {
  StickMode(const NormalMachine<Real>& machine, const std::vector<int>& signs);

  std::vector<std::size_t> sticking;
  Matrix<Real> free, held;  // orthonormal columns: motions that are left, and what the sticking directions span
  Real omega;               // of the free motions; makes e of one size
  ModeFlow<Real> flow;
  Matrix<Real> load_by_integral;           // the change of the load by the integral of e
  std::vector<Vector<Real>> held_columns;  // the pushes of the sticking directions, in coordinates of `held`
};

}  // namespace breakaway::campaign
