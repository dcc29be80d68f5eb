#include "breakaway/design/k3.hpp"

namespace breakaway::design {

InputError too_little_damping(double mass_kg, double stiffness_N_per_m, double damping_Ns_per_m) {
  const double critical = 2 * std::sqrt(stiffness_N_per_m) * std::sqrt(mass_kg);
  return InputError{"damping k22", "is " + to_text(damping_Ns_per_m) + " N s/m, so zeta = k22 / (2 sqrt(k1 m)) = " +
                                       to_text(damping_Ns_per_m / critical) +
                                       "; kicks need zeta > 1: raise k22 above " + to_text(critical)};
}

template class K3<float>;
template class K3<double>;

}  // namespace breakaway::design
