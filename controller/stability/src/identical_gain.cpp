#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/stability/equilibrium_set.hpp"
#include "gain_search.hpp"

namespace breakaway::stability {

using Eigen::MatrixXd;

double least_accepted(double first, const std::function<bool(double)>& accepts) {
  double refused = 0, accepted = first;
  for (int decade = 0; !accepts(accepted); ++decade) {
    if (decade == 12) return std::numeric_limits<double>::quiet_NaN();
    refused = accepted;
    accepted *= 10;
  }
  while (accepted - refused > 1e-9 * accepted) {
    const double middle = (refused + accepted) / 2;
    (accepts(middle) ? accepted : refused) = middle;
  }
  return accepted;
}

MatrixXd identical_position_gain(const ActuatedSystem& system, double wanted_m) {
  const MatrixXd& actuators = system.actuators;
  const MatrixXd squared = actuators * actuators.transpose();
  LinearMachine<> closed = system.machine;
  double best_m = std::numeric_limits<double>::infinity();
  const auto accepts = [&](double p) {
    closed.stiffness = system.machine.stiffness + p * squared;
    const double error_m = resting_error_m(closed);
    best_m = std::min(best_m, error_m);
    return error_m <= wanted_m;
  };
  const double force_N = (system.machine.directions * system.machine.friction_N).cwiseAbs().maxCoeff();
  const double scale = std::max({force_N / wanted_m, system.machine.stiffness.norm(), 1e-300}) / squared.norm();
  const double p = least_accepted(1e-6 * scale, accepts);
  if (std::isnan(p)) {
    throw InputError{"a resting error of " + to_text(wanted_m) +
                     " m is out of reach of identical gains: the best is about " + to_text(best_m) +
                     " m; ask for less, add actuators, or use full gains"};
  }
  return MatrixXd{p * actuators.transpose()};
}

MatrixXd identical_velocity_gain(const ActuatedSystem& system, const Accepts& accepts) {
  const MatrixXd& actuators = system.actuators;
  const MatrixXd squared = actuators * actuators.transpose();
  LinearMachine<> closed = system.machine;
  double best_J = 0;
  const auto accepts_gain = [&](double d) {
    closed.damping = system.machine.damping + d * squared;
    best_J = std::max(best_J, certify_attractivity(closed).rho_star_J);
    return accepts(closed);
  };
  const double d = least_accepted(1e-6 * damping_unit_Ns_per_m(system.machine) / squared.norm(), accepts_gain);
  if (std::isnan(d)) {
    throw InputError{"the region is out of reach of identical gains: the best is about " + to_text(best_J) +
                     " J; ask for less, add actuators, or use full gains"};
  }
  return MatrixXd{d * actuators.transpose()};
}

}  // namespace breakaway::stability
