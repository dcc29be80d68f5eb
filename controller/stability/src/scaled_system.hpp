// The machine and its actuators in units of one size, in which gains are sought: no unit of a coordinate, an actuator
// or a force then decides what is found.
#pragma once

#include <Eigen/Core>

#include "breakaway/stability/pd_design.hpp"

namespace breakaway::stability {

struct ScaledSystem {
  // With q = diag(unit) y, forces in the unit of force_unit(), and actuators whose columns have the length 1.
  ScaledSystem(const ActuatedSystem& given, const Eigen::VectorXd& unit);

  // The gain F of the given system whose twin in these units is `scaled`.
  Eigen::MatrixXd gain(const Eigen::MatrixXd& scaled) const;

  // A direction of motion in the given coordinates, of unit length.
  Eigen::VectorXd direction(const Eigen::VectorXd& scaled) const;

  ActuatedSystem system;
  Eigen::VectorXd coordinate, actuator;  // actuator: the lengths of the columns in these coordinates
  double force_N;
};

// In coordinates in which each mass is 1, where damping and stiffness are rates: 1/s and 1/s^2.
ScaledSystem in_mass_units(const ActuatedSystem& given);

}  // namespace breakaway::stability
