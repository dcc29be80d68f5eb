// LinearMachine: any linear mechanical system with dry friction, eqs. (1) and (2) of van de Wouw & Leine (stability
// properties of equilibrium sets):
//   M q'' + C q' + K q - W lambda = f,   lambda_i in -Lambda_ii Sign(g_i),   g = W^T q'.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <string>

namespace breakaway::plant {

template <int N>
struct MachineState {
  double time_s = 0;
  Eigen::Matrix<double, N, 1> q;  // generalized coordinates: m, or rad
  Eigen::Matrix<double, N, 1> v;  // their rates
};

// No constant force: zero where the size is known, else an empty vector, which means the same.
template <int N>
Eigen::Matrix<double, N, 1> no_force() {
  if constexpr (N == Eigen::Dynamic) return {};
  return Eigen::Matrix<double, N, 1>::Zero(N < 0 ? 0 : N);
}

// n = N coordinates and m = M friction elements, each known at compile time or Eigen::Dynamic.
template <int N = Eigen::Dynamic, int M = Eigen::Dynamic>
struct LinearMachine {
  Eigen::Matrix<double, N, N> mass;                     // M: n x n, symmetric and positive definite
  Eigen::Matrix<double, N, N> damping;                  // C: n x n, any
  Eigen::Matrix<double, N, N> stiffness;                // K: n x n, any
  Eigen::Matrix<double, N, M> directions;               // W_T: n x m, dependent columns allowed
  Eigen::Matrix<double, M, 1> friction_N;               // the diagonal of Lambda: mu_i |lambda_Ni| >= 0
  Eigen::Matrix<double, N, 1> force_N = no_force<N>();  // f: constant; empty means zero

  Eigen::Index coordinates() const { return mass.rows(); }
  Eigen::Index frictions() const { return directions.cols(); }
};

template <int N, int M>
Eigen::Matrix<double, N, 1> constant_force(const LinearMachine<N, M>& machine) {
  if (machine.force_N.size() == 0) return Eigen::Matrix<double, N, 1>::Zero(machine.coordinates());
  return machine.force_N;
}

// What is wrong with the machine and what to do about it; empty if nothing is.
template <int N, int M>
std::string validate(const LinearMachine<N, M>& machine) {
  const Eigen::Index n = machine.mass.rows(), m = machine.directions.cols();
  const auto shape = [](const auto& matrix) {
    return std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols());
  };
  const auto wrong_size = [&](const char* name, const auto& matrix, Eigen::Index rows, Eigen::Index columns) {
    if (matrix.rows() == rows && matrix.cols() == columns) return std::string{};
    return std::string{name} + " is " + shape(matrix) + ": make it " + std::to_string(rows) + " x " +
           std::to_string(columns) + ", to fit mass and directions";
  };
  if (n == 0) return "mass is empty: give a machine at least one coordinate";
  const Eigen::Index force_rows = machine.force_N.size() == 0 ? 0 : n;
  for (const auto& error :
       {wrong_size("mass", machine.mass, n, n), wrong_size("damping", machine.damping, n, n),
        wrong_size("stiffness", machine.stiffness, n, n), wrong_size("directions", machine.directions, n, m),
        wrong_size("friction_N", machine.friction_N, m, 1), wrong_size("force_N", machine.force_N, force_rows, 1)}) {
    if (!error.empty()) return error;
  }
  if (!machine.mass.allFinite()) return "mass has an entry that is not a finite number: correct it";
  if (!machine.damping.allFinite()) return "damping has an entry that is not a finite number: correct it";
  if (!machine.stiffness.allFinite()) return "stiffness has an entry that is not a finite number: correct it";
  if (!machine.directions.allFinite()) return "directions has an entry that is not a finite number: correct it";
  if (!machine.friction_N.allFinite()) return "friction_N has an entry that is not a finite number: correct it";
  if (!machine.force_N.allFinite()) return "force_N has an entry that is not a finite number: correct it";
  if (machine.mass != machine.mass.transpose())
    return "mass is not symmetric: use (M + M^T) / 2, the matrix of v^T M v";
  // Scaled to a unit diagonal, so that no unit of length or mass makes a good matrix look singular.
  if ((machine.mass.diagonal().array() <= 0).any() ||
      Eigen::LLT<Eigen::Matrix<double, N, N>>(machine.mass.diagonal().cwiseSqrt().cwiseInverse().asDiagonal() *
                                              machine.mass *
                                              machine.mass.diagonal().cwiseSqrt().cwiseInverse().asDiagonal())
              .info() != Eigen::Success) {
    return "mass is not positive definite: give every coordinate a mass of its own, or drop it";
  }
  for (Eigen::Index i = 0; i < m; ++i) {
    if (!(machine.friction_N[i] >= 0)) {
      return "friction_N[" + std::to_string(i) + "] is negative: give the magnitude mu |lambda_N| >= 0";
    }
  }
  return {};
}

// The closed loop (29) of the machine under u = -F1 q - F2 v through the actuators S of (28): n x p, p x n and p x n.
template <int N, int M, class Actuators, class PositionGain, class VelocityGain>
LinearMachine<N, M> with_feedback(LinearMachine<N, M> machine, const Actuators& actuators,
                                  const PositionGain& position_gain, const VelocityGain& velocity_gain) {
  machine.stiffness += actuators * position_gain;
  machine.damping += actuators * velocity_gain;
  return machine;
}

// The velocities after a generalized impulse (N s): v + M^-1 p.
template <int N, int M>
MachineState<N> after_impulse(const LinearMachine<N, M>& machine, MachineState<N> state,
                              const Eigen::Matrix<double, N, 1>& impulse_Ns) {
  state.v += machine.mass.llt().solve(impulse_Ns);
  return state;
}

// V of (5): kinetic energy plus that of the springs, without the constant force.
template <int N, int M>
double energy_J(const LinearMachine<N, M>& machine, const MachineState<N>& state) {
  return 0.5 * state.v.dot(machine.mass * state.v) + 0.5 * state.q.dot(machine.stiffness * state.q);
}

}  // namespace breakaway::plant
