#include "scaled_system.hpp"

#include "breakaway/stability/mass_units.hpp"

namespace breakaway::stability {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The lengths of columns, and 1 for a column of zeros.
VectorXd lengths(const MatrixXd& columns) {
  VectorXd length(columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double norm = columns.col(j).stableNorm();
    length[j] = norm > 0 ? norm : 1;
  }
  return length;
}

}  // namespace

ScaledSystem::ScaledSystem(const ActuatedSystem& given, const VectorXd& unit)
    : coordinate{unit}, force_N{force_unit(given.machine.mass)} {
  system.machine = in_units(in_force_unit(given.machine, force_N), coordinate);
  const MatrixXd columns = coordinate.asDiagonal() * given.actuators;
  actuator = lengths(columns);
  system.actuators = columns * actuator.cwiseInverse().asDiagonal();
}

MatrixXd ScaledSystem::gain(const MatrixXd& scaled) const {
  return force_N * (actuator.cwiseInverse().asDiagonal() * (scaled * coordinate.cwiseInverse().asDiagonal()));
}

VectorXd ScaledSystem::direction(const VectorXd& scaled) const {
  return coordinate.cwiseProduct(scaled).stableNormalized();
}

ScaledSystem in_mass_units(const ActuatedSystem& given) {
  return {given, mass_units(in_force_unit(given.machine, force_unit(given.machine.mass)).mass)};
}

}  // namespace breakaway::stability
