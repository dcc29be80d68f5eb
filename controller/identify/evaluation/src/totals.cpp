#include "totals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "breakaway/input/input_error.hpp"

namespace breakaway::evaluation {

void number_motions(Identification& found) {
  std::size_t motion = 0;
  int direction = 0;
  double position_m = 0;
  for (FrictionSample& sample : found.friction) {
    const bool goes_on =
        sample.direction == direction && sample.speed_m_s != 0 && direction * (sample.position_m - position_m) >= 0;
    if (!goes_on) ++motion;
    sample.motion = motion;
    direction = sample.direction;
    position_m = sample.position_m;
  }
  found.motions = motion;
}

void sum_up(Identification& found, const Margins& margins) {
  constexpr double far = std::numeric_limits<double>::infinity();
  found.friction_seen_N = {far, -far};
  found.travel_seen_m = {far, -far};
  for (const FrictionSample& sample : found.friction) {
    found.friction_seen_N.least = std::min(found.friction_seen_N.least, sample.friction_N.least);
    found.friction_seen_N.most = std::max(found.friction_seen_N.most, sample.friction_N.most);
    found.travel_seen_m.least = std::min(found.travel_seen_m.least, sample.position_m);
    found.travel_seen_m.most = std::max(found.travel_seen_m.most, sample.position_m);
  }
  found.bounds_N = {found.friction_seen_N.least * (1 - margins.friction),
                    found.friction_seen_N.most * (1 + margins.friction)};
  found.mass_uncertainty = std::max({found.mass_uncertainty, margins.mass, 2 * found.mass.spread_of_greatest(),
                                     found.mass.spread, 2 * found.mass.spread_of_lengths});
}

void require_friction(const Identification& found) {
  if (found.friction_seen_N.least > 0) return;
  throw InputError{fmt::format(
      "friction comes out at {:.4g} N at the least, and it cannot be 0 or less, so that something else pushes the "
      "axis: "
      "a load swings on a spring, or a weight pulls; for a load behind a motor with the encoder describe it roughly in "
      "a table [plant.load], and identify again; balance a weight",
      found.friction_seen_N.least)};
}

}  // namespace breakaway::evaluation
