// PD feedback of a machine with dry friction, (28) and (29) of [A]: which gains make Theorem 1 apply.
//
//   M q'' + C q' + K q - W lambda = S u,   u = -F1 q - F2 q'   =>   K_cl = K + S F1,   C_cl = C + S F2.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>
#include <vector>

#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

struct ActuatedSystem {
  LinearMachine<> machine;  // n coordinates; its damping and stiffness need neither be positive definite nor symmetric
  Eigen::MatrixXd actuators;  // S: n x k, the directions of the actuator forces; dependent columns allowed
};

struct PdGains {
  Eigen::MatrixXd position_N_per_m;   // F1: k x n
  Eigen::MatrixXd velocity_Ns_per_m;  // F2: k x n
};

// (29).
LinearMachine<> closed_loop(const ActuatedSystem& system, const PdGains& gains);

// No gain can change these conditions, so they decide whether there are gains at all. They are examined in mass units
// (mass_units.hpp), so that no unit changes the answer. With Z an orthonormal basis of
// the coordinates that no actuator acts on (Z^T S = 0), Z^T K_cl = Z^T K and Z^T C_cl = Z^T C.
//   stiffness_symmetric, stiffness_positive: Z^T K Z must be so. They are sufficient, too: then K_cl can be made
//     symmetric and positive definite;
//   damping_symmetric: the same of Z^T C Z, for C_cl;
//   stabilizable: the pair [-C, [W, S]], by Hautus' test. [A] puts it as equivalent to the existence of F2 with the
//     eigencolumns in span W; for a symmetric C_cl it is necessary, but not sufficient.
// A reason is empty where the condition holds; else it names the direction concerned and the remedy.
std::vector<Condition> machine_conditions(const ActuatedSystem& system);

// The three conditions on the gains in section 5 of [A]: K_cl symmetric and positive definite; the eigencolumns of C_cl
// with non-positive eigenvalues in span W; C_cl symmetric.
std::vector<Condition> loop_conditions(const LinearMachine<>& closed_loop);

// Theorem 2 of [A] for given gains: A = -K_cl^-1, Y = F1 A.
struct Theorem2 {
  Eigen::MatrixXd A, Y;  // n x n, k x n
  double hurwitz = 0;    // least eigenvalue of -A: A is Hurwitz when positive
  double lmi = 0;        // least eigenvalue of -(K A + A^T K^T + S Y + Y^T S^T): the inequality holds when positive
};

// The figures are lower bounds that hold in spite of rounding. K_cl must be invertible.
Theorem2 verify_theorem_2(const ActuatedSystem& system, const Eigen::MatrixXd& position_gain_N_per_m);

}  // namespace breakaway::stability
