// Random machines over the whole range that the certificates accept: 1 to 8 coordinates, up to 10 directions, masses,
// stiffnesses and frictions of ratios up to 1e12, damping that is strong, weak, absent, exactly singular, negative or
// skew, directions that are parallel, nearly so, dependent or switched off, and matrices that are not symmetric. Most
// of them are certified, some cannot be. A number gives the same machine on every computer but for the rounding of the
// mathematical library.
#pragma once

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "breakaway/stability/linear_machine.hpp"
#include "breakaway/stability/mass_units.hpp"

namespace breakaway::campaign {

class WildMachines {
 public:
  // `spread` is by how much of those powers of ten the sizes differ: 1 for ratios up to 1e12.
  explicit WildMachines(std::uint64_t number, double spread = 1)
      : random_{number * 0x9E3779B97F4A7C15u + 1}, spread_{spread} {}

  stability::LinearMachine<> machine() {
    const Eigen::Index n = 1 + below(8), m = below(11);
    stability::LinearMachine<> s;
    s.mass = unit_mass(n);
    s.stiffness = symmetric(n, log_uniform(n, -4, 4));
    s.directions = directions(n, m);
    s.friction_N = log_uniform(m, -6, 6);
    for (double& friction_N : s.friction_N) friction_N *= below(8) == 0 ? 0 : 1;
    s.damping = damping(s);
    const bool circulatory = below(20) == 0;
    s = stability::in_units(s, log_uniform(n, -3, 3));
    for (Eigen::MatrixXd* const matrix : {&s.mass, &s.stiffness}) *matrix = (*matrix + matrix->transpose()).eval() / 2;
    if (circulatory) s.stiffness(0, n - 1) *= 1 + 1e-3;  // not symmetric: refused, but for n = 1
    return s;
  }

  // A velocity or a place in all directions alike.
  Eigen::VectorXd anywhere(Eigen::Index n) { return normal(n, 1); }

  double uniform() { return (static_cast<double>(random_() >> 11) + 0.5) * 0x1p-53; }

 private:
  Eigen::Index below(int count) { return static_cast<Eigen::Index>(random_() % static_cast<std::uint64_t>(count)); }

  double normal() {
    const double radius = std::sqrt(-2 * std::log(uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

  Eigen::MatrixXd normal(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd matrix(rows, columns);
    for (double& entry : matrix.reshaped()) entry = normal();
    return matrix;
  }

  Eigen::VectorXd log_uniform(Eigen::Index size, double least, double greatest) {
    Eigen::VectorXd values(size);
    for (double& value : values) value = std::pow(10.0, spread_ * (least + (greatest - least) * uniform()));
    return values;
  }

  Eigen::MatrixXd rotation(Eigen::Index n) {
    return Eigen::HouseholderQR<Eigen::MatrixXd>(normal(n, n)).householderQ() * Eigen::MatrixXd::Identity(n, n);
  }

  // With the given eigenvalues, along the coordinates or turned.
  Eigen::MatrixXd symmetric(Eigen::Index n, const Eigen::VectorXd& values) {
    if (below(3) == 0) return values.asDiagonal();
    const Eigen::MatrixXd columns = rotation(n), matrix = columns * values.asDiagonal() * columns.transpose();
    return (matrix + matrix.transpose()) / 2;
  }

  Eigen::MatrixXd unit_mass(Eigen::Index n) {
    if (below(2) == 0) return Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd mass = symmetric(n, log_uniform(n, -1, 1));
    const Eigen::VectorXd scale = mass.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * mass * scale.asDiagonal();
    return (scaled + scaled.transpose()) / 2;
  }

  Eigen::MatrixXd directions(Eigen::Index n, Eigen::Index m) {
    Eigen::MatrixXd w = normal(n, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      switch (below(6)) {
        case 0:
          w.col(i) = Eigen::VectorXd::Unit(n, below(static_cast<int>(n)));
          break;
        case 1:
          if (i > 0) w.col(i) = w.col(i - 1) * (below(2) == 0 ? 1 : -2);
          break;
        case 2:
          if (i > 0) w.col(i) = w.col(i - 1) + std::pow(10.0, -12 * uniform()) * w.col(i);
          break;
        case 3:
          if (i > 1) w.col(i) = w.col(i - 1) - w.col(i - 2);
          break;
        default:
          break;
      }
    }
    return w;
  }

  // In mass units.
  Eigen::MatrixXd damping(const stability::LinearMachine<>& s) {
    const Eigen::Index n = s.coordinates(), m = s.frictions();
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(n, n);
    switch (below(6)) {
      case 0:
        break;  // none
      case 1:
        c = symmetric(n, log_uniform(n, -6, 6));
        break;
      case 2:  // a damper along one direction only: exactly singular, if its products are exact
        c = Eigen::VectorXd::Unit(n, below(static_cast<int>(n))).asDiagonal();
        break;
      case 3: {  // of any sign, weak or strong
        Eigen::VectorXd values = log_uniform(n, -6, 2);
        for (double& value : values) value *= below(3) == 0 ? -1 : 1;
        c = symmetric(n, values);
        break;
      }
      default: {  // positive where no friction acts, negative along frictions
        c = symmetric(n, log_uniform(n, -4, 2));
        if (m > 0) {
          const Eigen::MatrixXd fed = s.directions * log_uniform(m, -4, 0).asDiagonal();
          c -= fed * fed.transpose();
        }
        break;
      }
    }
    c = (c + c.transpose()).eval() / 2;
    if (below(4) == 0) {
      const Eigen::MatrixXd skew = normal(n, n);
      c += skew - skew.transpose();
    }
    return c;
  }

  std::mt19937_64 random_;
  double spread_;
};

}  // namespace breakaway::campaign
