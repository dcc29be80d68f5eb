// Motion in one direction under constant friction, in closed form.
//
// Travel coordinates: distance and speed along the direction of motion, time since the start; friction is a negative
// acceleration. Relative accuracy holds for flights however short: every formula is free of cancellation at tau -> 0.
#pragma once

#include "breakaway/motion/roots.hpp"

namespace breakaway::motion {

// speed' = acceleration + transient exp(-tau / time_constant) - 2 decay speed - stiffness distance, where either the
// transient or both feedback terms are zero. Times in s, lengths in m.
struct ConstantFrictionMotion {
  double speed_m_s = 0;          // at the start, >= 0
  double acceleration_m_s2 = 0;  // constant force less friction, per mass, at distance 0
  double transient_m_s2 = 0;     // at the start
  double time_constant_s = 1;    // > 0
  double decay_per_s = 0;        // damping / (2 mass) = zeta omega_n
  double stiffness_per_s2 = 0;   // stiffness / mass = omega_n^2

  bool has_feedback() const { return decay_per_s != 0 || stiffness_per_s2 != 0; }
  double speed_at(double tau_s) const;
  double distance_at(double tau_s) const;
  double acceleration_at(double tau_s) const;

  // The first instant in (0, horizon_s] at which the speed is zero; never for none.
  double first_rest_s(double horizon_s) const;
  // The instant at which the distance is reached; the speed must not change sign before horizon_s and the distance must
  // be passed by then.
  double time_to_distance_s(double distance_m, double horizon_s) const;
};

}  // namespace breakaway::motion
