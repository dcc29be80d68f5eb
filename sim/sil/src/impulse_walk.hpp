// A motion from impulse to impulse: the impulsive equation (8) of van de Wouw & Leine (impulsive control with uncertain
// friction), v+ = v- + M^-1 p.
#pragma once

#include <algorithm>
#include <cstdint>

#include "breakaway/hybrid/types.hpp"
#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::sil {

// Calls `run(start, end_s)` for the motion up to each impulse and to the end, and `follow_on(state)` with the state
// that no impulse will change any more. Returns the outcome of the last motion with the steps and events of all.
// Requires a start.
template <class RunTo, class FollowOn>
hybrid::Outcome<Eigen::Dynamic> walk_impulses(const scenario::MachineScenario& s, const RunTo& run,
                                              const FollowOn& follow_on) {
  hybrid::Outcome<Eigen::Dynamic> outcome;
  hybrid::MachineState<Eigen::Dynamic> state = *s.start;
  const auto run_to = [&](double end_s) {
    const std::uint64_t steps = outcome.steps, events = outcome.events;
    outcome = run(state, std::max(state.time_s, end_s));
    outcome.steps += steps;
    outcome.events += events;
    state = outcome.end;
  };
  for (const scenario::MachineImpulse& impulse : s.impulses) {
    run_to(impulse.time_s);
    state.time_s = std::max(state.time_s, impulse.time_s);  // it may have come to rest before
    state = stability::after_impulse(s.machine, state, impulse.impulse_Ns);
  }
  follow_on(state);
  run_to(s.duration_s);
  return outcome;
}

}  // namespace breakaway::sil
