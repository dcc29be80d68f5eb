// How far one kick of the coast "brake" moves an axis that rests, under constant friction.
//
// The force u behind a current loop with the time constant tau follows a command U as u = U + (u0 - U) e^(-t/tau), so
// in each phase, with f the friction and z = t/tau,
//   m v = m v0 + (U - f) t + (u0 - U) t phi1(z),            phi1 = (1 - e^-z) / z
//   m x = m x0 + m v0 t + (U - f) t^2 / 2 + (u0 - U) t^2 phi2(z),   phi2 = (z - 1 + e^-z) / z^2.
// The axis breaks away when u passes f, at t = tau ln((U - u0) / (U - f)). It stops where v = 0; while u falls, v is
// concave, so that Newton's method from the right never passes the root.
#pragma once

namespace breakaway::design {

// The forces of a kick as they act on the axis, towards the target. The cut and the brake act against the motion.
struct KickForces {
  double start_N = 0;  // of the current loop when the pulse begins; below the friction
  double pulse_N = 0;
  double pulse_s = 1;  // how long
  double cut_N = 0;
  double cut_s = 0;
  double brake_N = 0;  // below the friction
};

// All but lag_s, which may be 0, must be above 0.
struct KickedAxis {
  double mass_kg = 1;
  double friction_N = 1;
  double lag_s = 0;
};

// The travel from rest to the first stop [m]; 0 when the pulse does not break the axis away. Relative error about 1e-14
// where the pulse exceeds the friction by a tenth, and 1e-15 of what the same pulse moves without friction at worst.
double travel_m(const KickForces& kick, const KickedAxis& axis) noexcept;

}  // namespace breakaway::design
