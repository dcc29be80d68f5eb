// The two steps of synthesize(), each for both structures of gains.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/synthesis.hpp"

namespace breakaway::stability {

// Relative: what separates a limit that is asked of the solver from the one that is wanted.
constexpr double reserve = 1e-6;
// Where damping must not be negative it is asked to be above zero by this share of the size of C.
constexpr double damping_reserve = 1e-3;

// Is this closed loop good enough? Theorem 1 decides.
using Accepts = std::function<bool(const LinearMachine<>&)>;

// The largest |q_i| in E; infinite unless the stiffness is symmetric and positive definite.
double resting_error_m(const LinearMachine<>& system);

// F1 with resting_error_m of the closed loop at most `wanted_m`, finite.
Eigen::MatrixXd full_position_gain(const ActuatedSystem& system, double wanted_m);
Eigen::MatrixXd identical_position_gain(const ActuatedSystem& system, double wanted_m);

// F2 with a closed loop that is accepted; `everywhere` says that only B = everything is.
Eigen::MatrixXd full_velocity_gain(const ActuatedSystem& system, bool everywhere, const Accepts& accepts);
Eigen::MatrixXd identical_velocity_gain(const ActuatedSystem& system, const Accepts& accepts);

// The size of C; of a machine without damping a small part of sqrt(M K).
double damping_unit_Ns_per_m(const LinearMachine<>& machine);

// An argument that is accepted, close above one that is not: grown from `first` > 0 in decades, then bisected. NaN when
// none up to 1e12 times `first` is.
double least_accepted(double first, const std::function<bool(double)>& accepts);

}  // namespace breakaway::stability
