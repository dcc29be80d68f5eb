// Theorem 1 of [A]: where friction is sure to bring an unstable machine to rest.
//
// The energy V of (5) cannot grow inside { V < rho* }: there friction takes more power than the negative damping gives.
// Every motion that starts there ends in the equilibrium set (4). Each theorem as implemented: THEORY.md.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

// A Condition is one of the theorem's. Its margin says how far it is from failing, and is not positive where it fails.
struct Condition {
  std::string name;
  bool holds;
  double margin;
  std::string reason;  // what was found, and what the margin measures
};

struct Attractivity {
  bool certified = false;             // conditions 1 and 2 hold, so that rho_star > 0
  std::string reason;                 // why not, and the remedy; empty when certified
  bool definite = false;              // condition 1 holds, so that V is an energy: level_J and what follows are known
  std::vector<Condition> conditions;  // all three, as far as they could be examined; none for a malformed system
  Eigen::MatrixXd eigencolumns;       // U_c in mass units; of repeated eigenvalues those that make rho* large
  Eigen::VectorXd eigenvalues;        // 1/s, the diagonal of Omega_c, ascending: the first n_q are not positive
  Eigen::Index unstable = 0;          // n_q
  double alpha = 0;                   // the smallest for which (9) holds; 0 when n_q = 0
  double beta = 0;                    // N/sqrt(kg): 1 / alpha, infinite when n_q = 0
  Eigen::VectorXd rho_J;              // rho_i of (7), i = 1..n_q
  double rho_star_J = 0;              // (7); infinite: attractive from everywhere (remark 4)
  double level_J = 0;                 // >= rho_star_J: the larger level of energy_level.hpp, proven as well
  double greatest_rest_J = 0;         // the largest V in E; for more than 20 frictions an upper bound of it
  double remark_3_J = 0;  // half the left-hand side of remark 3: V at one corner of E, not always the largest
  bool all_of_E = false;  // condition 3: E lies inside { V < rho* }, and is attractive as a whole

  // The part of E that is certified to be attractive when all of E is not: E shrunk about 0 by this, 0..1.
  double certified_share_of_E() const;
  bool global() const { return std::isinf(level_J); }
};

// Works on the symmetric part of the damping: the skew part, as of gyroscopes, does no work, so (10) does not see it.
// Without condition 3 a motion from inside { V < rho* } still ends in E; only not all of E is certified.
//
// The theorem is applied in mass units (mass_units.hpp), so no unit of a coordinate changes what is said. What rests on
// a sign is proved for the stored numbers (definite_proof.hpp); what rounding hides is not certified, and the reason
// says so. An infinite level means that the damping is proved to give no power.
Attractivity certify_attractivity(const LinearMachine<>& machine);

// (27) of [A], for machines of the form (24): two masses, equal dampers c1 to the ground and c2 between them, friction
// on each mass. Valid, but four times smaller than (7) at equal friction. None for other machines, and for
// c1 + 2 c2 >= 0.
std::optional<double> closed_form_rho_J(const LinearMachine<>& system);

}  // namespace breakaway::stability
