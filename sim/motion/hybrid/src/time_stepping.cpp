#include "breakaway/hybrid/time_stepping.hpp"

#include "breakaway/input/input_error.hpp"
#include "breakaway/stability/dense.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::MatrixXd;

void require_valid(const LinearMachine<>& machine, const TimeSteppingOptions& options) {
  stability::require_valid(machine);
  if (!(options.step_s > 0) || !std::isfinite(options.step_s))
    throw InputError{"step_s is " + std::to_string(options.step_s) + ": give a finite time above 0"};
  if (!(options.theta >= 0 && options.theta <= 1))
    throw InputError{"theta is " + std::to_string(options.theta) +
                     ": give 0.5 for the midpoint rule, or another number from 0 to 1"};
}

}  // namespace

std::string theta_warning(const LinearMachine<>& machine, double theta) {
  if (theta == 0.5) return {};
  if (theta < 0.5) {
    return "theta below 1/2 feeds energy into every oscillation: use theta = 0.5 unless the step is very short";
  }
  const Eigen::VectorXd damping =
      stability::dense::symmetric_eigenvalues(stability::dense::symmetric_part(machine.damping));
  const double rounding = 1e-14 * damping.cwiseAbs().maxCoeff();
  if (damping[0] >= -rounding) return {};
  return "theta above 1/2 can give wrong answers here: damping is not positive semidefinite (least eigenvalue " +
         std::to_string(damping[0]) +
         " N s/m), and the damping that such a scheme adds may bring an unstable machine to rest; use theta = 0.5 or "
         "the event-driven method";
}

SteppingScheme make_stepping_scheme(const LinearMachine<>& machine, const TimeSteppingOptions& options) {
  namespace dense = stability::dense;
  require_valid(machine, options);
  const double h = options.step_s, theta = options.theta, before = 1 - theta;
  const MatrixXd matrix = machine.mass + h * theta * machine.damping + h * h * theta * theta * machine.stiffness;
  if (!dense::Cholesky(dense::symmetric_part(matrix)).succeeded()) {
    throw InputError{"step_s = " + std::to_string(h) +
                     " is too long for this machine: its negative damping or stiffness outweighs the "
                     "mass within one step; choose a shorter step"};
  }
  const MatrixXd inverse = dense::inverse(matrix);
  SteppingScheme scheme;
  scheme.from_v = inverse * (machine.mass - h * before * machine.damping - h * h * theta * before * machine.stiffness);
  scheme.from_q = inverse * (-h * machine.stiffness);
  scheme.free = inverse * (h * stability::constant_force(machine));
  scheme.to_v = inverse * machine.directions;
  scheme.coupling = machine.directions.transpose() * scheme.to_v;
  scheme.friction_holds_all =
      machine.frictions() > 0 && dense::span(machine.directions).rank() == machine.coordinates();
  return scheme;
}

template class TimeStepping<2, 2>;
template class TimeStepping<>;

}  // namespace breakaway::hybrid
