// Section 4 of van de Wouw & Leine, "Stability Properties of Equilibrium Sets ...": (24) with m = k = 1, c2 = -0.375.
#pragma once

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

inline LinearMachine<> two_mass_example(double c1 = 0.5) {
  constexpr double c2 = -0.375;
  LinearMachine<> s;
  s.mass = Eigen::Matrix2d::Identity();
  s.damping = Eigen::Matrix2d{{c1 + c2, -c2}, {-c2, c1 + c2}};
  s.stiffness = Eigen::Matrix2d{{2, -1}, {-1, 2}};
  s.directions = Eigen::Matrix2d::Identity();
  s.friction_N = Eigen::Vector2d::Ones();
  return s;
}

}  // namespace breakaway::stability
