// Presliding: friction whose contact first bends, as bristles do, and only then slides (Dahl 1968; LuGre: Canudas de
// Wit, Olsson, Astrom, Lischinsky 1995). With the bend z, the stiffness s0, the damping s1 and the level g,
//
//   z' = v - s0 |v| z / g,     friction on the mass  -(s0 z + s1 v max(0, 1 - s0 z sign(v) / g)).
//
// The level g is that of any FrictionLaw, g(t, x, |v|), so that friction in steady sliding stays within its bounds. For
// |s0 z| <= g the damping force is LuGre's s1 z'. Beyond that, where g has just fallen, s1 z' would pull the mass along
// and make energy out of nothing (Barahona and Canudas de Wit); here it is zero. So friction is passive for every level
// and every damping: with s = sign(v) and u = s0 z / g,
//
//   power into friction - rate of s0 z^2 / 2  =  s1 v^2 max(0, 1 - s u) + g |v| u^2  >=  0.
//
// Dahl's law is the one with s1 = 0.
#pragma once

#include <algorithm>
#include <cmath>

#include "breakaway/input/input_error.hpp"

namespace breakaway::model {

struct Presliding {
  double stiffness_N_per_m = 1;  // s0 > 0
  double damping_Ns_per_m = 0;   // s1 >= 0

  // These take the level g > 0 and the direction of motion, -1 or +1, whose smooth continuation past zero speed an
  // integrator may ask for.
  double load_share(double bend_m, double level_N) const { return stiffness_N_per_m * bend_m / level_N; }
  double bend_rate_m_s(double bend_m, double velocity_m_s, int direction, double level_N) const {
    return velocity_m_s * (1 - direction * load_share(bend_m, level_N));
  }
  double force_N(double bend_m, double velocity_m_s, int direction, double level_N) const {
    const double following = std::max(0.0, 1 - direction * load_share(bend_m, level_N));
    return stiffness_N_per_m * bend_m + damping_Ns_per_m * velocity_m_s * following;
  }
  double energy_J(double bend_m) const { return 0.5 * stiffness_N_per_m * bend_m * bend_m; }
};

// Throws InputError naming the member unless stiffness_N_per_m > 0 and damping_Ns_per_m >= 0, both finite.
void require_valid(const Presliding& presliding);

}  // namespace breakaway::model
