// The adaptive method to an accuracy of the result.
//
// A tolerance bounds the error of a step; what the steps add up to depends on the machine, which damps errors or feeds
// them, and on every stop on the way. So the error of a run is measured: the same motion is integrated again at a
// tolerance so much smaller that its own error does not count, and the distance of the two ends is the error of the
// first. A result that is not accurate enough is replaced by one at a smaller tolerance.
#pragma once

#include <cstdint>

#include "breakaway/hybrid/adaptive.hpp"
#include "breakaway/hybrid/refused.hpp"

namespace breakaway::hybrid {

struct AccurateOutcome {
  Outcome<Eigen::Dynamic> outcome;
  double error_estimate_m = 0;  // of the largest coordinate at the end, in its own unit
  double tolerance = 0;         // with which `outcome` was computed
  std::uint64_t steps = 0;      // of all runs
};

// Runs from `start` to rest or to end_time_s, so that no coordinate at the end is off by more than accuracy_m > 0, in
// the unit of the coordinates. `laws` are as Adaptive takes them; if there are none, friction is constant,
// machine.friction_N. Throws Refused when the accuracy cannot be held, naming the error that can, and when one of the
// runs takes more than most_steps; throws InputError as Adaptive does.
AccurateOutcome run_to_accuracy(const LinearMachine<>& machine, const Adaptive::Laws& laws,
                                const Adaptive::State& start, double end_time_s, double accuracy_m,
                                std::uint64_t most_steps = AdaptiveOptions{}.most_steps);

}  // namespace breakaway::hybrid
