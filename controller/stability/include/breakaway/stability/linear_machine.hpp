// LinearMachine: a linear mechanical system with dry friction, (1) and (2) of [A], and a constant force:
//
//   M q'' + C q' + K q - W lambda = f,   lambda_i in -p_i Sign(g_i),   g = W^T q'.
//
// Certificates, simulations and scenarios all take this one type. The certificates are about friction and springs:
// they leave the constant force out, which moves the place of rest by K^-1 f and nothing else.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>

#include "breakaway/stability/dense.hpp"

namespace breakaway::stability {

template <int N>
struct MachineState {
  double time_s = 0;
  Eigen::Matrix<double, N, 1> q;  // generalized coordinates: m, or rad
  Eigen::Matrix<double, N, 1> v;  // their rates
};

// Returns what stands for no constant force: zero where the size is known, else an empty vector, which means the same.
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
  Eigen::Matrix<double, N, M> directions;               // W: n x m, dependent columns allowed
  Eigen::Matrix<double, M, 1> friction_N;               // p: m, mu_i |lambda_Ni| >= 0
  Eigen::Matrix<double, N, 1> force_N = no_force<N>();  // f: constant; empty means zero

  Eigen::Index coordinates() const { return mass.rows(); }
  Eigen::Index frictions() const { return directions.cols(); }
};

// Returns the machine with sizes that the compiler knows, which makes simulation several times faster.
template <int N, int M>
LinearMachine<N, M> sized(const LinearMachine<>& machine) {
  LinearMachine<N, M> result{machine.mass, machine.damping, machine.stiffness, machine.directions, machine.friction_N};
  if (machine.force_N.size() > 0) result.force_N = machine.force_N;
  return result;
}

template <int N, int M>
LinearMachine<> unsized(const LinearMachine<N, M>& machine) {
  return {machine.mass, machine.damping, machine.stiffness, machine.directions, machine.friction_N, machine.force_N};
}

template <int N, int M>
Eigen::Matrix<double, N, 1> constant_force(const LinearMachine<N, M>& machine) {
  if (machine.force_N.size() == 0) return Eigen::Matrix<double, N, 1>::Zero(machine.coordinates());
  return machine.force_N;
}

// Throws InputError, whose key is the matrix concerned, unless K, W and p make an equilibrium set: sizes that fit,
// entries that are finite, friction that is not negative.
void require_valid_statics(const LinearMachine<>& machine);

// Asks the same of all of the machine.
void require_well_formed(const LinearMachine<>& machine);

// Asks, besides, for a mass that is symmetric and positive definite, without which nothing can be simulated.
void require_valid(const LinearMachine<>& machine);

// Says whether each entry equals the one across the diagonal but for the rounding of decimal numbers to double, 2^-53
// of each of the two. What differs by more is a skew part of the machine itself, and a skew stiffness can feed it.
bool symmetric(const Eigen::MatrixXd& matrix);

// The least eigenvalue of a symmetric matrix that is scaled to a unit diagonal, so that no unit of length or mass makes
// a good matrix look singular; the least diagonal entry if that is not positive.
double definiteness(const Eigen::MatrixXd& matrix);

// The closed loop (29) of the machine under u = -F1 q - F2 v through the actuators S of (28): n x p, p x n and p x n.
//
// S F is known to its rounding only, of which there is none where numbers of few digits are added. What it may have put
// into v^T K_cl v and v^T C_cl v is taken off their diagonals, so that no certificate of the closed loop rests on it.
// Where gains make two entries of K_cl or C_cl across the diagonal that differ by no more than this rounding,
// (p + 8) 2^-53 (|K| + |S| |F|) of each, both become their mean: they are meant to be equal.
LinearMachine<> with_feedback(LinearMachine<> machine, const Eigen::MatrixXd& actuators,
                              const Eigen::MatrixXd& position_gain, const Eigen::MatrixXd& velocity_gain);

// The velocities after a generalized impulse (N s): v + M^-1 p.
template <int N, int M>
MachineState<N> after_impulse(const LinearMachine<N, M>& machine, MachineState<N> state,
                              const Eigen::Matrix<double, N, 1>& impulse_Ns) {
  state.v += dense::Cholesky(machine.mass).solve(impulse_Ns);
  return state;
}

// V of (5): kinetic energy plus that of the springs, without the constant force.
template <int N, int M>
double energy_J(const LinearMachine<N, M>& machine, const MachineState<N>& state) {
  return 0.5 * state.v.dot(machine.mass * state.v) + 0.5 * state.q.dot(machine.stiffness * state.q);
}

}  // namespace breakaway::stability
