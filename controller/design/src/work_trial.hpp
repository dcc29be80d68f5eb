// A kick of the coast "work" as the controller gives it, tried on a motor and a load whose friction is constant for
// each way.
#pragma once

#include <array>

#include "breakaway/design/spring_load.hpp"

namespace breakaway::design::detail {

// What a trial starts from, and what the meter looks at.
struct WorkTrial {
  double motor_kg, load_kg, stiffness_N_per_m, gap_m;
  struct Friction {
    double towards_N, back_N;  // against motion towards the target, and against motion away from it
  };
  Friction motor_friction, load_friction;
  double period_s;
  int latency_periods;
  bool metered, encoder_on_load;
  double most_travel_m;  // of the motor with what it may go on for: law::WorkCycle
  double late_periods;
  double bent_m;  // motor less load as it starts

  struct End {
    double motor_m, load_m, bent_m;  // travel of each, and how they rest
    double coast_s;
  };
  // From rest, under a force that acts at once.
  End run(double force_N, int periods) const;
};

}  // namespace breakaway::design::detail
