// What the growth of certified regions takes from a machine, computed once.
#pragma once

#include <vector>

#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/equilibrium_set.hpp"

namespace breakaway::study {

struct RegionBounds {
  // Lost beyond |z| > level, z = (real + i imaginary) . (q, v); |z| changes by at most steepness * |x|.
  struct Escape {
    Eigen::VectorXd real, imaginary;
    double level, steepness;
  };

  double depth;               // sqrt(2 rho): how deep 0 lies inside { V < rho }, sqrt J
  double parting_rate_per_s;  // c
  double horizon_s;           // how long a motion is followed
  std::vector<Escape> escapes;
  stability::EquilibriumSet equilibria;
};

// Needs a positive definite K. Throws InputError when the equilibrium set has too many facets.
RegionBounds region_bounds(const stability::LinearMachine<>& machine, const sil::Certificates& certificates,
                           double horizon_s);

}  // namespace breakaway::study
