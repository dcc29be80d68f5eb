// How long the approach of the coast "brake" takes at most.
//
// Every axis of a class speeds up at least as the drive, or a move's limit, is sure to have it do against its greatest
// friction, and goes at least as fast as the curve that it comes down, and the speed that it is allowed, less what it
// may be slower than its plan. The time is that of a way at the least of these, with what the loop needs to begin and
// what brake and friction need to end it, up to the proof of rest.
//
// It is tested and not proved: that no friction within its bounds has an axis go slower than that on the whole way.
#pragma once

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design {

// From rest at the distance to the decision for the first kick, or to the hold [s]. A sample that is lost adds a
// period. Infinite where the speed is below least_approach_speed_m_s().
template <class Real>
double approach_s(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s, double distance_m);

// An axis that passes its target may come no nearer to it for so long, until it holds [s]: approaches from there, and
// all kicks with their proofs of rest.
template <class Real>
double without_progress_s(const BrakedClass& axes, const BrakedDesign<Real>& design, double max_speed_m_s,
                          double tolerance_m);

}  // namespace breakaway::design
