// PositionSine: what repeats along the travel, as the cogging force of a motor or the ripple of its torque.
#pragma once

#include <cmath>
#include <numbers>

#include "breakaway/input/input_error.hpp"

namespace breakaway::model {

// amplitude sin(2 pi position / period + phase). The amplitude is in N for cogging and a share in [0, 1) of the drive's
// force for torque ripple.
struct PositionSine {
  double amplitude = 0;
  double period_m = 1;  // > 0
  double phase_rad = 0;

  double wave_number_per_m() const { return 2 * std::numbers::pi / period_m; }
  double at(double position_m) const { return amplitude * std::sin(wave_number_per_m() * position_m + phase_rad); }
  double slope_per_m(double position_m) const {
    return amplitude * wave_number_per_m() * std::cos(wave_number_per_m() * position_m + phase_rad);
  }
};

// Throws InputError naming the member unless all are finite, amplitude >= 0 and period_m > 0.
void require_valid(const PositionSine& sine);

}  // namespace breakaway::model
