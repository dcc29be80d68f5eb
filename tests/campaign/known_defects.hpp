// What the campaign has found and nobody has mended yet: by number, with its cause. The test fails for every other
// defect, and for one of these that is no longer there.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "machine_comparison.hpp"

namespace breakaway::campaign {

struct KnownDefect {
  std::int64_t number;
  Method method;
  const char* cause;
};

inline constexpr std::array<KnownDefect, 0> known_defects{};

inline bool is_known_defect(std::int64_t number, Method method) {
  return std::any_of(known_defects.begin(), known_defects.end(),
                     [&](const KnownDefect& d) { return d.number == number && d.method == method; });
}

// Families of which a method is known to leave too many for a list. The test leaves it out there; a long campaign runs
// all of them.
inline bool is_clean(Family family, Method method) {
  switch (family) {
    case Family::stiff_damping:
    case Family::stiff_springs:
    case Family::non_normal:
    case Family::light_mass:
      return method == Method::event_driven;  // the others take more steps than the test has
    default:
      return true;
  }
}

}  // namespace breakaway::campaign
