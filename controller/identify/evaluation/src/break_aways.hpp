// Places where the axis broke away under a force that grew slowly.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "breakaway/evaluation/identification.hpp"

namespace breakaway::evaluation {

struct BreakAway {
  std::size_t at = 0;  // the first reading off the place of rest
  FrictionSample seen;
};

std::vector<BreakAway> break_aways_in(const Record& record, const LatencyEstimate& latency, double mass_kg);

// How stiff the axis is before it slides, at least: by how far it had moved under half of what broke it away, on ramps
// that began without force. Nothing where that was less than two counts.
std::optional<double> presliding_stiffness_N_per_m(const Record& record, const std::vector<BreakAway>& broken,
                                                   const LatencyEstimate& latency);

}  // namespace breakaway::evaluation
