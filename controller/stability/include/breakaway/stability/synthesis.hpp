// PD gains for what is wanted of a machine: how far from the target it may rest, and from where it is sure to come to
// rest. Section 5 of [A] shows the trade: gains of position shrink the equilibrium set E and the certified region B,
// gains of velocity grow B.
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "breakaway/input/input_error.hpp"
#include "breakaway/input/numbers.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/pd_design.hpp"

namespace breakaway::stability {

struct PdWants {
  // > 0: no coordinate rests farther from 0 than this, to 1e-9 of it.
  double resting_error_m = std::numeric_limits<double>::infinity();
  double region_J = 0;  // >= 0: B = { V < rho* } with rho* at least this; infinite: attractive from everywhere
  double reach_m = 0;   // >= 0: every rest with |q| < reach_m, the Euclidean norm, lies in B
  // What counts as 1 m of each coordinate in these wants, > 0, so that metres and radians can be wanted together; 1
  // where it is empty.
  Eigen::VectorXd unit = {};
};

enum class GainStructure {
  full,      // every actuator uses all coordinates; by linear matrix inequalities, which need the program sdpa
  identical  // u = -p S^T q - d S^T q': every actuator uses its own coordinate, all alike; needs no sdpa
};

struct PdDesign {
  PdGains gains;
  LinearMachine<> closed_loop;
  Attractivity attractivity;  // of the closed loop: all of E is certified
  Eigen::VectorXd extent_m;   // the largest |q_i| in E
  double reach_m = 0;         // every rest with |q| below this, in the unit of the wants, lies in B; may be infinite
};

// Called with the share of the search that is done, 0 to 1, as far as it can be foreseen.
using DesignProgress = std::function<void(double share)>;

// The gains of position first, as they decide about E: none if the machine is good enough as it is, else
//   full: those of the softest closed loop, which has the greatest reach for a given rho* (rho* does not depend on K):
//     maximise the least eigenvalue of Q = K_cl^-1, in which the resting error is linear. With A = -Q and Y = -F1 Q
//     this is the inequality of Theorem 2, normalised to K A + S Y = -I, which keeps K_cl symmetric and loses nothing.
//     What the actuators add is kept above 1 % of the machine's own stiffness;
//   identical: the least p.
// Then the least gains of velocity for the region, the reach and for all of E to lie in B:
//   full: the least spectral norm of F2 under which the eigenvalues of C_cl are above a limit -g, for the largest
//     g that will do, searched for with Theorem 1 itself. Norm, eigenvalues and limit are those in mass units
//     (mass_units.hpp), with actuators of unit length there;
//   identical: the least d.
// What rests on definite damping is designed with a margin, whatever is wanted. "Attractive from everywhere": the
// eigenvalues of C_cl are at least 1e-3 of the size of C, both in mass units. Else that holds on the motions that no
// friction feels. A machine without damping has the size of a thousandth of its fastest oscillation, and no more is
// asked for than a direction has by itself that no actuator acts on.
//
// The same machine in other units of its coordinates, actuators, time and force has the same gains in these units: to
// the last bit where the units differ by powers of two, of time and coordinates in any case.
//
// Whatever the search does, the result has passed Theorem 1 and the exact equilibrium set. Errors name what no gain can
// change (see machine_conditions), or the best that was found instead.
PdDesign synthesize(const ActuatedSystem& system, const PdWants& wants, GainStructure structure,
                    const DesignProgress& progress = {});

// The region of attraction as the velocity gains grow: Figure 4 of [A].
struct GainSweepRow {
  double velocity_gain_Ns_per_m;  // spectral norm of the scaled F2: d1 for u = -d1 q'
  double rho_star_J;
  bool E_certified;
};

// Returns a row for each of the norms, to which F2 is scaled while F1 stays as it is. F2 must not be zero.
std::vector<GainSweepRow> sweep_velocity_gain(const ActuatedSystem& system, const PdGains& gains,
                                              const std::vector<double>& norms_Ns_per_m);

}  // namespace breakaway::stability
