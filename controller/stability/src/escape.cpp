#include "breakaway/stability/escape.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "breakaway/stability/dense.hpp"

namespace breakaway::stability {
namespace {

// The largest |sum_j c_j s_j| over |s_j| <= 1: the farthest corner of a zonogon. Its corners are the ends of its edges,
// and on the edge along c_j, with the outward normal +-i c_j, every other s_k has the sign of c_k along that normal.
double farthest(const Eigen::VectorXcd& c) {
  const auto along = [](std::complex<double> direction, std::complex<double> x) {
    return (std::conj(direction) * x).real();
  };
  double most = 0;
  for (const std::complex<double> edge : c) {
    for (const double side : {1.0, -1.0}) {
      const std::complex<double> normal = edge * std::complex<double>{0, side};
      std::complex<double> corner = 0;
      for (const std::complex<double> x : c) {
        const double outward = along(normal, x);
        const bool parallel = std::abs(outward) <= 1e-14 * std::abs(edge) * std::abs(x);
        corner += (parallel ? along(edge, x) : outward) >= 0 ? x : -x;
      }
      most = std::max(most, std::abs(corner));
    }
  }
  return most;
}

}  // namespace

std::vector<EscapeLevel> escape_levels(const LinearMachine<>& system) {
  const Eigen::Index n = system.mass.rows();
  const dense::Cholesky mass(system.mass);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  a.topRightCorner(n, n).setIdentity();
  a.bottomLeftCorner(n, n) = -mass.solve(system.stiffness);
  a.bottomRightCorner(n, n) = -mass.solve(system.damping);
  const Eigen::MatrixXd pushes = mass.solve(system.directions * system.friction_N.asDiagonal());

  const dense::GeneralEigen eigen = dense::general_eigen(a.transpose());
  const double standing_still = 1e-12 * eigen.values.cwiseAbs().maxCoeff();
  std::vector<EscapeLevel> levels;
  for (Eigen::Index i = 0; i < 2 * n; ++i) {
    const std::complex<double> s = eigen.values[i];
    if (!(s.real() > standing_still) || s.imag() < 0) continue;  // of a conjugate pair one is enough
    const Eigen::VectorXcd w = eigen.vectors.col(i);
    const double push = farthest(pushes.transpose() * w.tail(n));
    levels.push_back({w.real(), w.imag(), s.real(), (1 + 1e-9) * push / s.real()});
  }
  return levels;
}

}  // namespace breakaway::stability
