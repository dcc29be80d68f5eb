// A machine in units in which every coordinate alone has the mass 1: q = D y with D = diag(M_ii)^(-1/2), so that
//   M' = D M D (of unit diagonal),   C' = D C D,   K' = D K D,   W' = D W,   f' = D f,   p and V as they are.
//
// Which damping is strong, which direction lies in span W and what is zero to rounding are then questions about the
// machine, whatever units of length, mass or angle its coordinates are given in. C' is in 1/s, K' in 1/s^2, and beta of
// (9) in N/sqrt(kg).
#pragma once

#include <Eigen/Core>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

// Returns the diagonal of D. The mass must have a positive diagonal.
Eigen::VectorXd mass_units(const Eigen::MatrixXd& mass);

// A power of two near the first mass, to divide M, C, K, p and f by. A root of twice the mass has other digits; in this
// unit of force a machine of twice the masses and forces has the same.
double force_unit(const Eigen::MatrixXd& mass);

// Returns the machine with its forces, and with them its energies, divided by `unit`.
LinearMachine<> in_force_unit(LinearMachine<> machine, double unit);

// Returns the machine in coordinates y with q = diag(unit) y.
LinearMachine<> in_units(const LinearMachine<>& machine, const Eigen::VectorXd& unit);

}  // namespace breakaway::stability
