#include "power_proof.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/mass_units.hpp"
#include "infinite.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using extended::Matrix;

// |w_i|_{M^-1} of each direction.
VectorXd mobilities(const LinearMachine<>& in_mass_units) {
  const Matrix inverse_factor = extended::inverse_cholesky_factor(in_mass_units.mass.cast<long double>());
  return (inverse_factor * in_mass_units.directions.cast<long double>()).colwise().norm().transpose().cast<double>();
}

}  // namespace

PowerProof::PowerProof(const LinearMachine<>& machine)
    : system_{machine.damping.cast<long double>()},
      directions_{machine.directions.cast<long double>()},
      definite_{positive_definite(machine.damping)},
      semidefinite_{definite_ == Proof::holds ? Proof::holds : positive_semidefinite(machine.damping)},
      unit_dampers_{VectorXd::Zero(machine.frictions())} {
  const LinearMachine<> scaled = in_units(machine, mass_units(machine.mass));
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * static_cast<double>(machine.coordinates());
  mobility_margin_ = 1 + rounding / std::max(definiteness(machine.mass), rounding / 4);
  const VectorXd mobility = mobilities(scaled);
  for (Index i = 0; i < machine.frictions(); ++i) {
    if (machine.friction_N[i] > 0 && mobility[i] > 0) unit_dampers_[i] = machine.friction_N[i] / mobility[i];
  }
  dampers_ = VectorXd::Zero(machine.frictions());
  found_ = definite_ == Proof::holds;
  if (found_ || !unit_dampers_.allFinite() || unit_dampers_.isZero(0)) return;
  const double strongest_kg = unit_dampers_.dot(mobility.cwiseAbs2());
  const double damping_per_s = dense::symmetric_part(scaled.damping).cwiseAbs().maxCoeff();
  find_dampers(damping_per_s > 0 ? damping_per_s / strongest_kg : 1);
}

bool PowerProof::proves(const MatrixXd& forces) const {
  const Matrix y = forces.cast<long double>();
  const Matrix middle = system_ + directions_ * y * directions_.transpose();
  const Matrix size = system_.cwiseAbs() + directions_.cwiseAbs() * y.cwiseAbs() * directions_.cwiseAbs().transpose();
  const auto terms = static_cast<long double>(2 * forces.rows() + 4);
  return positive_definite(middle, terms * std::numeric_limits<long double>::epsilon() * size) == Proof::holds;
}

// The least dampers that are proved, to 1e-10. Both too weak and too strong ones fail: where no friction acts, the
// damping is lost in the rounding of strong ones.
void PowerProof::find_dampers(double kappa) {
  constexpr int weakest = -80, strongest = 100;
  const auto good = [&](double candidate) { return proves((candidate * unit_dampers_).asDiagonal()); };
  int exponent = weakest;
  while (exponent <= strongest && !good(std::ldexp(kappa, exponent))) exponent += 2;
  if (exponent > strongest) return;
  double proved = std::ldexp(kappa, exponent), refused = proved / 4;
  while (proved > (1 + 1e-10) * refused) {
    const double middle = std::sqrt(proved * refused);
    (good(middle) ? proved : refused) = middle;
  }
  found_ = true;
  kappa_ = proved;
  dampers_ = kappa_ * unit_dampers_;
}

double PowerProof::level_J() const {
  if (everywhere()) return infinite;
  const double kappa = kappa_ * mobility_margin_;
  return found_ ? 1 / (2 * kappa * kappa) : 0;
}

MatrixXd PowerProof::completed(const MatrixXd& forces) const {
  for (double share = 1e-15; share < 0.1; share *= 10) {
    MatrixXd candidate = forces;
    candidate.diagonal() += share * dampers_;
    if (candidate.allFinite() && proves(candidate)) return candidate;
  }
  return {};
}

}  // namespace breakaway::stability
