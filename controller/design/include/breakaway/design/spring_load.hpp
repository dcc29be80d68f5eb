// A load that hangs on the motor by a spring, where the controller takes both for one mass: what the spring adds to the
// kicks of the coast "brake", and from which resonance on that is little enough.
//
// Let M = m1 + m2 be motor and load, K the spring, w^2 = K (1/m1 + 1/m2), A1 and A2 the least friction of either side,
// A their sum, b the brake, H what the spring may hold at rest, F the force of a pulse and t its time. The work of F
// over the motor's travel in the pulse, and of b after it, goes into friction and the spring, so that the axis goes
// further than one rigid mass by at most
//   (F + b) E / (A + b) + (H + A')^2 / (2 K (A + b)), A' of the side without the encoder,
// where the motor goes further in the pulse by at most
//   E = 2 (rho (F - A1) + (1 + rho) H) / (M w^2) + A2 t s / M, rho = m2/m1, s^2 = 2 (A2 + H) m1 / ((F - A1) K):
// it swings about the rigid motion, and the load's friction is not there until the spring has broken it away, s later.
// Each term is a bound for an encoder on the motor and friction of at least A1 and A2; that nothing else counts, and
// that the axis settles where the resonance is above 1.2 a period, the pulse at least a quarter of a swing of the motor
// on the spring, and rest waits for the mass that the encoder does not see, is tested and not proved.
#pragma once

#include "breakaway/law/friction_bounds.hpp"

namespace breakaway::design {

struct BrakedClass;
template <class Real>
struct BrakedDesign;

// All must be above 0, the bounds of the load's friction as well.
struct SpringLoad {
  double motor_kg = 0;
  double load_kg = 0;
  double stiffness_N_per_m = 0;  // at least
  law::FrictionBounds<double> motor_friction{};
  law::FrictionBounds<double> load_friction{};
  bool encoder_on_load = false;
  double gap_m = 0;             // of a backlash between them, at most; only the coast "work" is made for one
  double damping_Ns_per_m = 0;  // of the spring, at least; only the coast "work" asks for it

  double resonance_Hz() const;
  double critical_damping_Ns_per_m() const;  // of the swing of motor and load against each other
  // The side that the encoder does not see may rest so far from where it seems to, while a force of at most load_N acts
  // beside the drive's.
  double unseen_m(double load_N) const;

  friend constexpr bool operator==(const SpringLoad&, const SpringLoad&) = default;
};

// Motion of the whole, as a rigid axis would have made it, that the encoder need not show while no count of it changes;
// 0 for a class without a spring_load.
double lost_motion_m(const BrakedClass& axes);

// What a pulse of this force, as commanded, and of so many periods may go further than one of a rigid axis; 0 for a
// class without a spring_load.
double sprung_m(const BrakedClass& axes, double brake_N, double force_N, int periods);

// The time that the mass out of sight may swing on without a count of the other.
double sprung_rest_s(const BrakedClass& axes, double brake_N);

// What a spring asks of an axis that is to settle, of which each is little enough with a stiffer one.
struct SpringDemand {
  double nearest_m = 0;         // that a pulse of one period may go further, at most
  double beyond_m = 0;          // the same of any kick
  double swing_s = 0;           // the shortest pulse that is long enough
  double least_per_period = 0;  // resonance, in swings a period

  // About the least resonance with which the axis is safe at this tolerance, if its masses stay.
  double safe_from_Hz(const BrakedClass& axes, double tolerance_m) const;
};

// For a class with a spring_load.
template <class Real>
SpringDemand spring_demand(const BrakedClass& axes, const BrakedDesign<Real>& design);

}  // namespace breakaway::design
