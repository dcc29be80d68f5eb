#include "breakaway/stability/mass_units.hpp"

#include <cmath>

namespace breakaway::stability {
namespace {

// One factor after the other, as their product might overflow.
Eigen::MatrixXd scaled(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& unit) {
  return unit.asDiagonal() * (matrix * unit.asDiagonal());
}

}  // namespace

Eigen::VectorXd mass_units(const Eigen::MatrixXd& mass) { return mass.diagonal().cwiseSqrt().cwiseInverse(); }

double force_unit(const Eigen::MatrixXd& mass) { return std::ldexp(1.0, std::ilogb(mass(0, 0))); }

LinearMachine<> in_force_unit(LinearMachine<> machine, double unit) {
  for (Eigen::MatrixXd* const matrix : {&machine.mass, &machine.damping, &machine.stiffness}) *matrix /= unit;
  machine.friction_N /= unit;
  machine.force_N /= unit;
  return machine;
}

LinearMachine<> in_units(const LinearMachine<>& machine, const Eigen::VectorXd& unit) {
  LinearMachine<> result = machine;
  result.mass = scaled(machine.mass, unit);
  result.damping = scaled(machine.damping, unit);
  result.stiffness = scaled(machine.stiffness, unit);
  result.directions = unit.asDiagonal() * machine.directions;
  if (machine.force_N.size() > 0) result.force_N = unit.asDiagonal() * machine.force_N;
  return result;
}

}  // namespace breakaway::stability
