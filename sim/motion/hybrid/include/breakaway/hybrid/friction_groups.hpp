// FrictionGroups: the directions of a machine as far as they make a difference to its motion.
//
// A direction without friction, or that moves nothing, holds nothing: its column becomes zero, and it never sticks.
// Directions that are parallel, to what rounding can tell apart, are one direction that bears the sum of their
// frictions: all stick or slide alike.
#pragma once

#include <vector>

#include "breakaway/hybrid/types.hpp"

namespace breakaway::hybrid {

// Directions whose angle is below this, in the metric of the mass, are parallel. Taking them for one changes the
// forces by at most this share.
inline constexpr double parallel_angle = 2e-12;

struct FrictionGroups {
  // By direction: the first one that is parallel to it, itself if there is none; -1 if it is switched off.
  std::vector<int> leader;
  // By direction: c, if it is c times its leader; 0 if it is switched off.
  std::vector<double> multiple;
  // W_T and friction with the columns of all but leaders zero. The friction of a leader is that of its group: a
  // direction c w bears |c| times its friction along w.
  LinearMachine<> machine;
};

// `machine` passes require_valid().
FrictionGroups group_frictions(LinearMachine<> machine);

}  // namespace breakaway::hybrid
