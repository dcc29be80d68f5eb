// The same machine written in other units, for tests that ask for the same answer.
#pragma once

#include <cmath>
#include <random>

#include "breakaway/stability/mass_units.hpp"
#include "breakaway/stability/pd_design.hpp"

namespace breakaway::stability {

// q = diag(length) q', t = time t', forces and actuator forces in their own units.
struct OtherUnits {
  Eigen::VectorXd length, actuator;
  double time = 1, force = 1;

  LinearMachine<> machine(const LinearMachine<>& given) const {
    LinearMachine<> twin = in_units(given, length);
    if (given.mass == given.mass.transpose()) even_out(twin.mass);
    if (given.stiffness == given.stiffness.transpose()) even_out(twin.stiffness);
    twin.mass *= force / time / time;
    twin.damping *= force / time;
    twin.stiffness *= force;
    twin.friction_N *= force;
    return twin;
  }
  // Factors that are no powers of two round both halves of a symmetric matrix.
  static void even_out(Eigen::MatrixXd& matrix) { matrix = (matrix + matrix.transpose()).eval() / 2; }

  ActuatedSystem system(const ActuatedSystem& given) const {
    return {machine(given.machine), length.asDiagonal() * given.actuators * actuator.asDiagonal()};
  }
  Eigen::MatrixXd position_gain(const Eigen::MatrixXd& given) const {
    return force * (actuator.cwiseInverse().asDiagonal() * given * length.asDiagonal());
  }
  Eigen::MatrixXd velocity_gain(const Eigen::MatrixXd& given) const { return position_gain(given) / time; }
};

// Powers of two from 2^-reach to 2^reach, or any numbers in between.
inline OtherUnits random_units(std::mt19937_64& random, Eigen::Index n, Eigen::Index k, double reach, bool powers) {
  std::uniform_real_distribution<double> exponent{-reach, reach};
  const auto one = [&] {
    const double drawn = exponent(random);
    return std::exp2(powers ? std::round(drawn) : drawn);
  };
  const auto several = [&](Eigen::Index size) { return Eigen::VectorXd::NullaryExpr(size, one).eval(); };
  OtherUnits units{several(n), several(k)};
  units.time = one();
  units.force = one();
  return units;
}

}  // namespace breakaway::stability
