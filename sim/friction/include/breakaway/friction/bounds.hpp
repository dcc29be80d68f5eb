// The bounds that Assumption 1 of van de Wouw & Leine (impulsive control with uncertain friction) puts on the friction.
#pragma once

namespace breakaway::friction {

// Friction force level in newtons (newton metres for a rotary axis): 0 < lower <= level <= upper.
struct FrictionBounds {
  double lower_N;
  double upper_N;

  // Throws std::invalid_argument naming the parameter unless 0 < lower_N <= upper_N < infinity.
  FrictionBounds(double lower_N, double upper_N);

  // The same bounds from the paper's coefficients: m g mu. Throws std::invalid_argument naming the parameter unless
  // mass_kg > 0, gravity_m_s2 > 0 and 0 < mu_lower <= mu_upper, all finite.
  static FrictionBounds from_coefficients(double mass_kg, double gravity_m_s2, double mu_lower, double mu_upper);
};

}  // namespace breakaway::friction
