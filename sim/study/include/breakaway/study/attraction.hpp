// What is proved of a machine's equilibrium set: the theorem of the paper, its sweep over a gain, and the region of
// attraction in a plane.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/certificates.hpp"
#include "breakaway/stability/attractivity.hpp"
#include "breakaway/stability/equilibrium_set.hpp"
#include "breakaway/study/certified_region.hpp"

namespace breakaway::study {

struct SweepRow {
  double d1;
  stability::Attractivity attractivity;
};

struct Attraction {
  sil::Certificates certificates;
  stability::EquilibriumSet equilibria;
  std::optional<double> closed_form_J;    // rho* by (27), where that applies
  std::vector<SweepRow> sweep;            // as the file asks for
  std::optional<CertifiedRegion> region;  // where anything is certified

  const stability::Attractivity& attractivity() const { return certificates.attractivity; }
};

struct AttractionOptions {
  std::array<int, 2> plane{0, 1};  // places in (q, v), 0..2n-1
  double half_width = 0;           // 0: that fits
  int depth = 10;                  // 0..14
  int threads = 1;                 // >= 1; the result does not depend on it
  RegionProgress progress{};
};

// Throws InputError as certify_region().
Attraction find_attraction(const scenario::MachineScenario& scenario, const AttractionOptions& options);

}  // namespace breakaway::study
