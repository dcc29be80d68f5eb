// Theorem 1 of [A]: where friction is sure to bring an unstable machine to rest.
//
// The energy V of (5) cannot grow inside { V < rho* }: there friction takes more power than the negative damping gives.
// Every motion that starts there ends in the equilibrium set (4).
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>
#include <string>

#include "breakaway/design/linear_system.hpp"

namespace breakaway::design {

struct Attractivity {
  bool certified = false;        // conditions 1 and 2 hold, so that rho_star > 0
  std::string reason;            // why not, and the remedy; empty when certified
  Eigen::MatrixXd eigencolumns;  // U_c
  Eigen::VectorXd eigenvalues;   // the diagonal of Omega_c, ascending: the first n_q are not positive
  Eigen::Index unstable = 0;     // n_q
  double alpha = 0;              // the smallest for which (9) holds; 0 when n_q = 0
  double beta = 0;               // 1 / alpha, infinite when n_q = 0
  Eigen::VectorXd rho_J;         // rho_i of (7), i = 1..n_q
  double rho_star_J = 0;         // (7); infinite: attractive from everywhere (remark 4)
  double greatest_rest_J = 0;    // the largest V in E; for more than 20 frictions an upper bound of it
  bool all_of_E = false;         // condition 3: E lies inside { V < rho* }, and is attractive as a whole
};

// Works on the symmetric part of the damping: the skew part, as of gyroscopes, does no work, so (10) does not see it.
// Without condition 3 a motion from inside { V < rho* } still ends in E; only not all of E is certified.
Attractivity certify_attractivity(const LinearSystem& system);

}  // namespace breakaway::design
