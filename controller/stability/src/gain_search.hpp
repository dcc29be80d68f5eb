// The two steps of synthesize(), each for both structures of gains.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/synthesis.hpp"

namespace breakaway::stability {

// A limit that is asked of the solver is apart from the one that is wanted by this share of it.
constexpr double reserve = 1e-6;
// Where damping must not be negative it is asked to be above zero by this share of the size of C.
constexpr double damping_reserve = 1e-3;

// The part of a search from one share of the way to another.
struct SearchProgress {
  const DesignProgress& tell;
  double from, to;

  void at(double share) const {
    if (tell) tell(from + (to - from) * share);
  }
};

// What Theorem 1 says of the closed loop with an F2.
struct Assessment {
  bool accepted;      // it is good enough
  double rho_star_J;  // 0 where nothing is certified
};
using Assess = std::function<Assessment(const Eigen::MatrixXd& velocity_gain_Ns_per_m)>;

// The largest |q_i| / limit_i in E; infinite unless the stiffness is symmetric and positive definite.
double resting_error(const LinearMachine<>& system, const Eigen::VectorXd& limit_m);

// Returns an F1 for which resting_error() of the closed loop is at most 1. Wants are named in messages as multiples of
// `wanted_m`.
Eigen::MatrixXd full_position_gain(const ActuatedSystem& system, const Eigen::VectorXd& limit_m, double wanted_m,
                                   const SearchProgress& progress);
Eigen::MatrixXd identical_position_gain(const ActuatedSystem& system, const Eigen::VectorXd& limit_m, double wanted_m,
                                        const SearchProgress& progress);

// Returns an F2 for which the closed loop is accepted; `everywhere` says that only B = everything is.
Eigen::MatrixXd full_velocity_gain(const ActuatedSystem& system, bool everywhere, const Assess& assess,
                                   const SearchProgress& progress);
Eigen::MatrixXd identical_velocity_gain(const ActuatedSystem& system, const Assess& assess,
                                        const SearchProgress& progress);

// The size of C in mass units; of a machine without damping a small part of the root of K.
double damping_unit_per_s(const LinearMachine<>& in_mass_units);

// Returns an argument that is accepted, within 1e-9 above one that is not (of itself, or of `first` if it is less):
// grown from `first` > 0 in decades, then bisected. NaN when none up to 1e24 times `first` is.
double least_accepted(double first, const std::function<bool(double)>& accepts, const SearchProgress& progress);

}  // namespace breakaway::stability
