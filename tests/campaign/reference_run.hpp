// The motion of a LinearMachine, computed independently of sim/motion: Gauss' principle decides friction, matrix
// exponentials by scaling and squaring carry the motion, and events are located to rounding. On numbers of 113 bits it
// is the judge; on the processor's own it may acquit, where it agrees with what was computed in another way, and never
// condemn.
#pragma once

#include <cstddef>

#include "breakaway/stability/linear_machine.hpp"
#include "dense_algebra.hpp"

namespace breakaway::campaign {

using Machine = stability::LinearMachine<>;
using State = stability::MachineState<Eigen::Dynamic>;

enum class ReferenceEnd {
  at_rest,   // and for ever
  time_up,   // still moving at the end
  too_long,  // more work than was allowed
  unclear    // no decision about friction could be made, or the motion grew beyond 1e200
};

struct ReferenceRun {
  ReferenceEnd end = ReferenceEnd::unclear;
  Vector<Quad> q, v;                      // at the end: n each
  double rest_s = 0;                      // when rest began, if at_rest
  double greatest_q = 0, greatest_v = 0;  // the largest entries met on the way
  std::size_t events = 0;
  double work = 0;  // multiplications
};

// `machine` passes require_valid(). `most_work`: some 1e7 a second on numbers of 113 bits, and 4e8 on Fast ones.
template <class Real>
ReferenceRun run_reference(const Machine& machine, const State& start, double end_s, double most_work);

}  // namespace breakaway::campaign
