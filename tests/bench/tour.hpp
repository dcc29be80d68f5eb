// Moves to targets at growing distance from zero: a long approach, and kicks over ever shorter distances.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace breakaway::bench {

struct TargetMove {
  double time_s;
  double position_m;
};
inline constexpr std::array<TargetMove, 5> tour{{{0, 0}, {2.6, 0.1}, {3.0, 0.11}, {3.4, 0.1105}, {3.8, 0.11052}}};
inline constexpr double tour_s = 4.2;

inline std::int32_t target_counts(double time_s, double resolution_m) {
  double target_m = 0;
  for (const TargetMove& move : tour) {
    if (move.time_s <= time_s) target_m = move.position_m;
  }
  return static_cast<std::int32_t>(std::llround(target_m / resolution_m));
}

}  // namespace breakaway::bench
