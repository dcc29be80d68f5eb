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

// Says whether the test runs this family when nobody asks for another: no machine of it is known to fail, or those
// that do are on the list.
inline bool is_clean(Family family) {
  switch (family) {
    case Family::ordinary:
    case Family::redundant:
    case Family::negative_damping:
    case Family::ties:
    case Family::overdamped:
    case Family::constant_force:
    case Family::mirrored:
    case Family::gyroscopic:
    case Family::circulatory:
    case Family::many:
      return true;
    default:
      return false;
  }
}

}  // namespace breakaway::campaign
