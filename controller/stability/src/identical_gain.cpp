#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/stability/mass_units.hpp"
#include "gain_search.hpp"
#include "scaled_system.hpp"

namespace breakaway::stability {

using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// S S^T in other coordinates.
MatrixXd squared(const MatrixXd& actuators, const VectorXd& coordinate) {
  const MatrixXd scaled = coordinate.asDiagonal() * actuators;
  return scaled * scaled.transpose();
}

}  // namespace

double least_accepted(double first, const std::function<bool(double)>& accepts, const SearchProgress& progress) {
  constexpr int most_decades = 24, bisections = 34;  // the latter for 1e-9 of a decade
  double refused = 0, accepted = first;
  for (int decade = 0; !accepts(accepted); ++decade) {
    if (decade == most_decades) return std::numeric_limits<double>::quiet_NaN();
    refused = accepted;
    accepted *= 10;
  }
  for (int step = 0; accepted - refused > 1e-9 * std::max(accepted, first); ++step) {
    progress.at(std::min(1.0, static_cast<double>(step) / bisections));
    const double middle = (refused + accepted) / 2;
    (accepts(middle) ? accepted : refused) = middle;
  }
  return accepted;
}

MatrixXd identical_position_gain(const ActuatedSystem& system, const VectorXd& limit_m, double wanted_m,
                                 const SearchProgress& progress) {
  const MatrixXd& actuators = system.actuators;
  double best = std::numeric_limits<double>::infinity();
  const auto accepts = [&](double p) {
    const MatrixXd gain = p * actuators.transpose();
    const double error = resting_error(closed_loop(system, {gain, MatrixXd::Zero(gain.rows(), gain.cols())}), limit_m);
    best = std::min(best, error);
    return error <= 1;
  };
  const LinearMachine<> scaled = in_units(system.machine, limit_m);
  const double force_J = (scaled.directions * scaled.friction_N.asDiagonal()).cwiseAbs().rowwise().sum().maxCoeff();
  const double most = std::max({force_J, scaled.stiffness.norm(), std::numeric_limits<double>::min()});
  const double p = least_accepted(1e-6 * most / squared(actuators, limit_m).norm(), accepts, progress);
  if (std::isnan(p)) {
    if (std::isinf(best))
      throw InputError{
          "no identical gains within reach make the stiffness symmetric and positive definite by so much "
          "that a resting error of " +
          to_text(wanted_m) + " m can be told from rounding; ask for less, add actuators, or use full gains"};
    throw InputError{"a resting error of " + to_text(wanted_m) +
                     " m is out of reach of identical gains: the best is about " + to_text(best * wanted_m) +
                     " m; ask for less, add actuators, or use full gains"};
  }
  return MatrixXd{p * actuators.transpose()};
}

MatrixXd identical_velocity_gain(const ActuatedSystem& system, const Assess& assess, const SearchProgress& progress) {
  const MatrixXd& actuators = system.actuators;
  double best_J = 0;
  const auto accepts = [&](double d) {
    const Assessment found = assess(d * actuators.transpose());
    best_J = std::max(best_J, found.rho_star_J);
    return found.accepted;
  };
  const ScaledSystem scaled = in_mass_units(system);
  const double least = 1e-6 * damping_unit_per_s(scaled.system.machine) / squared(actuators, scaled.coordinate).norm();
  const double d = least_accepted(scaled.force_N * least, accepts, progress);
  if (std::isnan(d)) {
    throw InputError{"the region is out of reach of identical gains: the best is about " + to_text(best_J) +
                     " J; ask for less, add actuators, or use full gains"};
  }
  return MatrixXd{d * actuators.transpose()};
}

}  // namespace breakaway::stability
