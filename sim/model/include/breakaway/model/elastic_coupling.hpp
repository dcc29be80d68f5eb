// ElasticCoupling: the spring, the damping and the backlash between a motor and its load.
#pragma once

#include <algorithm>
#include <cmath>

#include "breakaway/input/input_error.hpp"

namespace breakaway::model {

// With the deflection e = motor - load and half the gap h, the squeeze is s = max(0, |e| - h), and the force that
// resists e is K s + D s' while that presses and s > 0, else zero: teeth push and do not pull. Without a gap the
// coupling is a spring with damping, K e + D e'. It is passive:
// force times e' - rate of K s^2 / 2 is D s'^2 in contact, and -K s s' >= 0 while the teeth leave each other.
struct ElasticCoupling {
  double stiffness_N_per_m = 1;  // K > 0
  double damping_Ns_per_m = 0;   // D >= 0
  double gap_m = 0;              // the whole play, >= 0

  // What the teeth do: `side` is the sign of e where they meet, 0 in the gap.
  double squeeze_m(double deflection_m, int side) const { return side * deflection_m - 0.5 * gap_m; }
  double pressing_N(double deflection_m, double rate_m_s, int side) const {
    return stiffness_N_per_m * squeeze_m(deflection_m, side) + damping_Ns_per_m * side * rate_m_s;
  }
  double energy_J(double deflection_m) const {
    const double squeeze_m = gap_m == 0 ? deflection_m : std::max(0.0, std::abs(deflection_m) - 0.5 * gap_m);
    return 0.5 * stiffness_N_per_m * squeeze_m * squeeze_m;
  }
};

// Throws InputError naming the member that is out of its range or not finite.
void require_valid(const ElasticCoupling& coupling);

}  // namespace breakaway::model
