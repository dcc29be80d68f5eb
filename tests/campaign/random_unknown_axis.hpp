// Random axes of which an experiment knows nothing.
#pragma once

#include "../unknown_axis.hpp"
#include "random_braked_axis.hpp"

namespace breakaway::campaign {

using testing::UnknownAxis;

// Friction of 1 to 5.4 N on 0.5 to 3.2 kg with 50 N, or all of that many times as heavy and as strong; friction varies
// by up to 15 % with place and direction.
inline UnknownAxis random_unknown_axis(Random& r) {
  UnknownAxis axis;
  axis.mass_kg = r.between(0.5, 3.2);
  axis.friction_N = r.between(1.2, 4.7);
  if (r.share() < 0.6) {
    const double scale = r.decades(0.05, 200) / axis.mass_kg;
    axis.mass_kg *= scale, axis.friction_N *= scale, axis.max_force_N *= scale, axis.force_step_N *= scale;
  }
  axis.wave = r.between(0, 0.15);
  axis.tilt = (0.15 - axis.wave) * r.between(-1, 1);
  axis.wave_length_m = (axis.highest_m - axis.lowest_m) * r.between(0.4, 2);
  axis.phase = r.between(0, 6.3);
  if (r.share() < 0.3) axis.rise_at_rest = r.between(0, 0.1);
  axis.stribeck_m_s = r.decades(0.003, 0.1);
  axis.latency_periods = 1 + static_cast<int>(r.between(0, 3));
  if (r.share() < 0.5) axis.lag_s = r.between(0, 2e-3);
  axis.start_m = r.between(-0.2, 0.2);
  return axis;
}

}  // namespace breakaway::campaign
