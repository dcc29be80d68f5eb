// Machines and friction laws of the tests of Adaptive.
#pragma once

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/model/shapes.hpp"

namespace breakaway::hybrid {

using State = MachineState<Eigen::Dynamic>;

inline LinearMachine<> two_masses() {
  LinearMachine<> machine;
  machine.mass = Eigen::Matrix2d::Identity();
  machine.damping = Eigen::Matrix2d{{0.125, 0.375}, {0.375, 0.125}};
  machine.stiffness = Eigen::Matrix2d{{2, -1}, {-1, 2}};
  machine.directions = Eigen::Matrix2d::Identity();
  machine.friction_N = Eigen::Vector2d{1, 1};
  return machine;
}

inline LinearMachine<> unequal_masses() {
  LinearMachine<> machine = two_masses();
  machine.mass = Eigen::Matrix2d{{0.5, 0}, {0, 2}};
  machine.damping = Eigen::Matrix2d{{0.25, -0.125}, {-0.0625, 0.125}};
  machine.stiffness = Eigen::Matrix2d{{3, -1}, {-1, 1.5}};
  machine.friction_N = Eigen::Vector2d{0.375, 0.75};
  return machine;
}

inline LinearMachine<> stribeck_machine() { return unequal_masses(); }

inline Adaptive::Laws stribeck_laws() {
  return {{model::FrictionBounds{0.25, 0.5}, model::shape::stribeck(0.25)},
          {model::FrictionBounds{0.375, 1}, model::shape::stribeck_gaussian(0.5)}};
}

inline State stribeck_start() { return {0, Eigen::Vector2d{2, -1.5}, Eigen::Vector2d{0.5, 1}}; }

// Steps of 1e-12 relative to states of about one, and limits that give way at 1 + 1e-12 of theirs; some ten events.
inline constexpr double tolerance = 2e-11;

}  // namespace breakaway::hybrid
