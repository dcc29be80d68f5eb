// Where the spring between motor and load was bent, slowly, one way and back, and where the load then broke away.
//
// While the load holds, the motor creeps on under a force that grows, along the spring, and turns only once the force
// is less by the friction of the motor either way: what it has more than the spring differs by f(forward) + f(back).
#pragma once

#include <vector>

#include "breakaway/evaluation/record.hpp"
#include "swing_fit.hpp"

namespace breakaway::evaluation {

struct Bend {
  std::size_t at = 0;  // the reading at which the force turned
  double position_m = 0;
  double motor_N = 0;  // mean of the motor's friction either way
  double slack_N = 0;  // the motor crept this much further, as a force of the spring
  double force_N = 0;  // by which the force changed as it crept
};
std::vector<Bend> bends_in(const Record& record, const Swing& swing, double stiffness_N_per_m);

constexpr std::size_t least_bends = 6;

// In a gap the motor moves without the spring, and the spring of another swing gives way further than the joint's does.
// Throws InputError. Fewer than least_bends tell neither.
void require_tight(const std::vector<Bend>& bends, double stiffness_N_per_m, double resolution_m);

// A slow ramp from rest until motor and load slide.
struct SprungBreakAway {
  std::size_t at = 0;
  double position_m = 0;
  int direction = 1;
  double both_N = 0;  // the greatest friction of both together on the way
};
std::vector<SprungBreakAway> sprung_break_aways_in(const Record& record, const Swing& swing, double mass_kg);

}  // namespace breakaway::evaluation
