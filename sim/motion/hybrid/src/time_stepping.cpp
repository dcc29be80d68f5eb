#include "breakaway/hybrid/time_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "breakaway/hybrid/refused.hpp"
#include "breakaway/hybrid/stop_problem.hpp"
#include "breakaway/stability/dense.hpp"

namespace breakaway::hybrid {
namespace {

using Eigen::MatrixXd;

void require_valid(const LinearMachine<>& machine, const TimeSteppingOptions& options) {
  stability::require_valid(machine);
  if (!(options.step_s > 0) || !std::isfinite(options.step_s))
    throw InputError{"step_s is " + shown(options.step_s) + ": give a finite time above 0"};
  if (!(options.theta >= 0 && options.theta <= 1))
    throw InputError{"theta is " + shown(options.theta) +
                     ": give 0.5 for the midpoint rule, or another number from 0 to 1"};
}

// Dependent directions share their impulses in any way, which sweeps find; nearly dependent ones in one way only, to
// which sweeps creep.
bool nearly_dependent(const MatrixXd& coupling) {
  Eigen::VectorXd scale = coupling.diagonal();
  for (double& entry : scale) entry = entry > 0 ? 1 / std::sqrt(entry) : 0;
  const MatrixXd scaled = scale.asDiagonal() * stability::dense::symmetric_part(coupling) * scale.asDiagonal();
  const Eigen::VectorXd values = stability::dense::symmetric_eigenvalues(scaled);
  return std::ranges::any_of(values, [](double value) { return value > 1e-14 && value < 1e-3; });
}

// The directions that have friction.
std::vector<Eigen::Index> rubbing(const Eigen::VectorXd& limit_Ns) {
  std::vector<Eigen::Index> found;
  for (Eigen::Index i = 0; i < limit_Ns.size(); ++i) {
    if (limit_Ns[i] > 0) found.push_back(i);
  }
  return found;
}

}  // namespace

bool nearly_dependent(const LinearMachine<>& machine) {
  return nearly_dependent(
      MatrixXd{machine.directions.transpose() * stability::dense::inverse(machine.mass) * machine.directions});
}

bool solve_impulses(const MatrixXd& coupling, const Eigen::VectorXd& limit_Ns, const Eigen::VectorXd& sliding_m_s,
                    Eigen::VectorXd& impulse_Ns) {
  const std::vector<Eigen::Index> index = rubbing(limit_Ns);
  if (index.size() > most_directions) {
    throw Refused{"the impulses of a step could not be found for " + std::to_string(index.size()) +
                      " directions, some of which are nearly dependent",
                  "leave out some of these, so that no more than 16 are left"};
  }
  StopProblem<long double> problem(static_cast<Eigen::Index>(index.size()));
  problem.coupling = coupling(index, index).cast<long double>();
  problem.acceleration = sliding_m_s(index).cast<long double>();
  problem.rounding = 4e-16L * problem.acceleration.cwiseAbs();
  problem.forward_N = problem.backward_N = limit_Ns(index).cast<long double>();
  const auto solution = sliding_after_stop(problem);
  if (!solution) {
    throw Refused{"the impulses of a step cannot be decided in double precision",
                  "leave out one of the directions that are nearly parallel",
                  "set [run] integrator to \"event_driven\""};
  }
  impulse_Ns.setZero();
  impulse_Ns(index) = solution->force_N;
  return solution->signs.isZero(0);
}

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
         shown(damping[0]) +
         " N s/m), and the damping that such a scheme adds may bring an unstable machine to rest; use theta = 0.5 or "
         "the event-driven method";
}

SteppingScheme make_stepping_scheme(const LinearMachine<>& machine, const TimeSteppingOptions& options) {
  namespace dense = stability::dense;
  require_valid(machine, options);
  const double h = options.step_s, theta = options.theta, before = 1 - theta;
  const MatrixXd matrix = machine.mass + h * theta * machine.damping + h * h * theta * theta * machine.stiffness;
  if (!dense::Cholesky(dense::symmetric_part(matrix)).succeeded()) {
    throw Refused{"step_s = " + shown(h) +
                      " is too long for this machine, whose negative damping or stiffness outweighs the mass within "
                      "one step",
                  "choose a shorter step"};
  }
  const MatrixXd inverse = dense::inverse(matrix);
  SteppingScheme scheme;
  scheme.from_v = inverse * (machine.mass - h * before * machine.damping - h * h * theta * before * machine.stiffness);
  scheme.from_q = inverse * (-h * machine.stiffness);
  scheme.free = inverse * (h * stability::constant_force(machine));
  scheme.to_v = inverse * machine.directions;
  scheme.coupling = machine.directions.transpose() * scheme.to_v;
  const Eigen::Index n = machine.coordinates();
  scheme.unheld = machine.frictions() > 0 ? dense::span(machine.directions).complement : MatrixXd::Identity(n, n);
  scheme.friction_holds_all = scheme.unheld.cols() == 0;
  scheme.nearly_dependent = nearly_dependent(scheme.coupling);
  return scheme;
}

template class TimeStepping<2, 2>;
template class TimeStepping<>;

}  // namespace breakaway::hybrid
