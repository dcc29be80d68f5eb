#include "region_bounds.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "breakaway/input/input_error.hpp"
#include "breakaway/stability/energy_level.hpp"

namespace breakaway::study {
namespace {

constexpr double margin = 1e-12;  // more than the rounding of V and z

// The largest |z| over |x| = 1: the root of the largest eigenvalue of [a b]^T P^-1 [a b], P = diag(K, M).
double steepness(const stability::LinearMachine<>& machine, const stability::EscapeLevel& escape) {
  const Eigen::Index n = machine.coordinates();
  Eigen::MatrixX2d parts(2 * n, 2);
  parts << escape.real, escape.imaginary;
  const Eigen::Matrix2d gram = parts.topRows(n).transpose() * machine.stiffness.llt().solve(parts.topRows(n)) +
                               parts.bottomRows(n).transpose() * machine.mass.llt().solve(parts.bottomRows(n));
  const double mean = gram.trace() / 2;
  return std::sqrt(mean + std::hypot((gram(0, 0) - gram(1, 1)) / 2, gram(0, 1)));
}

}  // namespace

RegionBounds region_bounds(const stability::LinearMachine<>& machine, const sil::Certificates& certificates,
                           double horizon_s) {
  RegionBounds bounds{std::sqrt(2 * certificates.attractivity.level_J) * (1 - margin),
                      stability::parting_rate_per_s(machine),
                      horizon_s,
                      {},
                      stability::EquilibriumSet::make(machine)};
  for (const stability::EscapeLevel& escape : certificates.escapes) {
    const double steep = steepness(machine, escape) * (1 + margin);
    bounds.escapes.push_back({escape.real, escape.imaginary, escape.level * (1 + margin), steep});
  }
  return bounds;
}

}  // namespace breakaway::study
