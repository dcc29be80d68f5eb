// The energy V of (5) of [A] certifies more than Theorem 1 does. THEORY.md says why, in "The dissipated level" and "Two
// motions".
//
// [A] = van de Wouw & Leine, "Stability Properties of Equilibrium Sets of Controlled Linear Mechanical Systems with Dry
// Friction".
#pragma once

#include "breakaway/stability/linear_machine.hpp"

namespace breakaway::stability {

// A level rho such that friction takes more power than the damping gives, v^T C v + p^T |W^T v| > 0, for every v != 0
// with v^T M v < 2 rho. Infinite when the damping gives nothing; 0 when there is none. That needs C to be positive
// definite on the velocities without friction, W^T v = 0: necessary, and weaker than condition 2 of Theorem 1.
// Never below rho* of (7) but for rounding. `machine` without errors, M positive definite. With more than a million
// candidates for corners it is the smaller level that dampers in place of friction prove.
double dissipated_level_J(const LinearMachine<>& machine);

// c >= 0 such that two motions of the same system part at most as e^(c t) in the metric |x|^2 = v^T M v + q^T K q = 2
// V, whatever their friction does: the largest power of the negative damping, -v^T C v <= c v^T M v. 1/s, rounded up.
// `system` as above, K positive semidefinite.
double parting_rate_per_s(const LinearMachine<>& system);

}  // namespace breakaway::stability
