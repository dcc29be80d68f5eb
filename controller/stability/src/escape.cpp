#include "breakaway/stability/escape.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "breakaway/stability/dense.hpp"
#include "breakaway/stability/extended.hpp"
#include "breakaway/stability/mass_units.hpp"
#include "breakaway/stability/twofold.hpp"

namespace breakaway::stability {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

// The largest |sum_j c_j s_j| over |s_j| <= 1: the farthest corner of a zonogon. Its corners are the ends of its edges,
// and on the edge along c_j, with the outward normal +-i c_j, every other s_k has the sign of c_k along that normal.
double farthest(const VectorXcd& c) {
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

using Twofold = twofold::Matrix;

Twofold exactly(const MatrixXd& matrix) { return matrix.cast<DoubleDouble>(); }

// A power of two near a number, by which a product is not rounded.
double power_of_two(double x) { return std::exp2(std::round(std::log2(x))); }

// The machine as y' = A y + B lambda, with y = (q, q') in units in which every mass is about 1 and springs, or dampers
// if there are none, are of the size 1. A mass matrix that is nearly singular magnifies every rounding, so that nothing
// is rounded before it is inverted, in 31 digits.
struct FirstOrder {
  extended::Matrix a;
  MatrixXd pushes;
  VectorXd unit;    // (q, q') = unit y
  double rounding;  // of A, relative to its norm

  explicit FirstOrder(const LinearMachine<>& given) {
    LinearMachine<> machine = in_force_unit(given, force_unit(given.mass));
    const VectorXd coordinate = mass_units(machine.mass).unaryExpr(&power_of_two);
    machine = in_units(machine, coordinate);
    const Index n = machine.coordinates();
    const Twofold inverse = twofold::inverse(exactly(machine.mass));
    const auto over_mass = [&inverse](const MatrixXd& right) -> extended::Matrix {
      return Twofold{inverse.lazyProduct(exactly(right))}.cast<long double>();
    };
    const double springs = std::sqrt(machine.stiffness.norm()), dampers = machine.damping.norm();
    const double rate_per_s = springs > 0 ? power_of_two(springs) : dampers > 0 ? power_of_two(dampers) : 1;
    a = extended::Matrix::Zero(2 * n, 2 * n);
    a.topRightCorner(n, n).diagonal().setConstant(rate_per_s);
    a.bottomLeftCorner(n, n) = -over_mass(machine.stiffness) / rate_per_s;
    a.bottomRightCorner(n, n) = -over_mass(machine.damping);
    pushes = MatrixXd::Zero(2 * n, machine.frictions());
    pushes.bottomRows(n) =
        over_mass(machine.directions).cast<double>() * (machine.friction_N / rate_per_s).asDiagonal();
    unit = VectorXd(2 * n);
    unit << coordinate, rate_per_s * coordinate;
    const double condition = machine.mass.norm() * inverse.cast<double>().norm();
    rounding = static_cast<double>(std::numeric_limits<long double>::epsilon()) + condition * digits_of_the_inverse;
  }

 private:
  static constexpr double digits_of_the_inverse = 0x1p-100;  // of the 106 bits some are lost in its sums
};

// The eigenvalues of A, their left eigenvectors, and how far rounding may have moved both: to first order an error of
// the size e in A moves a value s_i by e |w_i| |x_i|, x being the right eigenvectors with w_i . x_i = 1, and w_i by
// e sum_j |w_j| |x_j| / |s_i - s_j|. Where eigenvectors are nearly parallel, both are as large as can be.
class Modes {
 public:
  explicit Modes(const FirstOrder& first) {
    const extended::GeneralEigen eigen = extended::general_eigen(first.a.transpose());
    eigen_ = {eigen.values.cast<std::complex<double>>(), eigen.vectors.cast<std::complex<double>>()};
    const Index size = count();
    if (size == 0) return;  // none were found
    MatrixXd both(2 * size, 2 * size);
    both << eigen_.vectors.real(), -eigen_.vectors.imag(), eigen_.vectors.imag(), eigen_.vectors.real();
    const MatrixXd inverse = dense::inverse(both).topRows(size);
    rounding_ = 64 * static_cast<double>(size) * first.rounding * static_cast<double>(first.a.norm());
    condition_ = inverse.rowwise().norm();
  }

  Index count() const { return eigen_.values.size(); }
  std::complex<double> value(Index i) const { return eigen_.values[i]; }
  VectorXcd left(Index i) const { return eigen_.vectors.col(i); }

  double value_error(Index i) const { return rounding_ * condition_[i]; }

  // Values that are equal to rounding share their eigenvectors.
  double vector_error(Index i) const {
    double error = std::numeric_limits<double>::epsilon();
    for (Index j = 0; j < count(); ++j) {
      const double apart = std::abs(value(i) - value(j));
      if (apart > 4 * (value_error(i) + value_error(j))) error += rounding_ * condition_[j] / apart;
    }
    return error;
  }

 private:
  dense::GeneralEigen eigen_;
  VectorXd condition_;  // |w_i| |x_i|
  double rounding_ = 0;
};

}  // namespace

std::vector<EscapeLevel> escape_levels(const LinearMachine<>& system) {
  constexpr double slowest = 1e-12, vector_margin = 1e-12, level_margin = 1e-9;
  const FirstOrder first{system};
  if (!first.a.cast<double>().allFinite() || !first.pushes.allFinite()) return {};
  const Modes modes{first};
  std::vector<EscapeLevel> levels;
  for (Index i = 0; i < modes.count(); ++i) {
    const std::complex<double> s = modes.value(i);
    if (!(s.real() > slowest * std::abs(s)) || s.imag() < 0) continue;  // of a conjugate pair one is enough
    if (!(modes.value_error(i) <= level_margin / 4 * s.real() && modes.vector_error(i) <= vector_margin)) continue;
    const VectorXcd w = modes.left(i);
    const double push = farthest(first.pushes.transpose() * w) + vector_margin * first.pushes.colwise().norm().sum();
    const VectorXcd raw = w.cwiseQuotient(first.unit.cast<std::complex<double>>());
    levels.push_back({raw.real(), raw.imag(), first.unit, s.real(), (1 + level_margin) * push / s.real()});
  }
  std::stable_sort(levels.begin(), levels.end(),
                   [](const EscapeLevel& a, const EscapeLevel& b) { return a.growth_rate > b.growth_rate; });
  return levels;
}

}  // namespace breakaway::stability
