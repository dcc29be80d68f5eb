// AppliedForce: the finite part u of the control input, eq. (3) of van de Wouw & Leine, as the actuator produces it.
#pragma once

#include <cmath>

namespace breakaway::model {

// u(t, x, v) = constant + transient exp(-(t - start) / time_constant) - stiffness (x - reference) - damping v.
// A sampled drive needs the first two terms (a held force, and a current loop that settles on it); the continuous PD
// law (4) the last two. time_constant_s > 0 where transient_N is not zero; all finite.
struct AppliedForce {
  double constant_N = 0;
  double transient_N = 0;
  double time_constant_s = 0;
  double start_s = 0;
  double stiffness_N_per_m = 0;
  double damping_Ns_per_m = 0;
  double reference_m = 0;

  double transient_at_N(double time_s) const {
    return transient_N == 0 ? 0 : transient_N * std::exp(-(time_s - start_s) / time_constant_s);
  }
  double at_N(double time_s, double position_m, double velocity_m_s) const {
    return constant_N + transient_at_N(time_s) - stiffness_N_per_m * (position_m - reference_m) -
           damping_Ns_per_m * velocity_m_s;
  }
  bool has_feedback() const { return stiffness_N_per_m != 0 || damping_Ns_per_m != 0; }
};

}  // namespace breakaway::model
