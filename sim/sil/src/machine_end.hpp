// Where a machine's motion ends by one method or another, and nothing else: no modes, no trace, no certificates.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "breakaway/scenario/machine_scenario.hpp"
#include "breakaway/sil/accuracy.hpp"

namespace breakaway::sil {

struct MachineEnd {
  Eigen::VectorXd q_m;
  double time_s = 0;        // when the motion ended; its duration where it did not come to rest
  std::uint64_t steps = 0;  // segments, time steps, or steps of the adaptive method
  std::uint64_t events = 0;

  double distance_m(const MachineEnd& other) const { return (q_m - other.q_m).cwiseAbs().maxCoeff(); }
};

// Throw InputError as the method does, and when the end is not finite. Require a start.

// `first_step` (0 to 1] is the length of the first time step in units of the others: it says where in a step the motion
// begins, and other methods do not know it.
MachineEnd machine_end(const scenario::MachineScenario& scenario, const Method& method, double first_step = 1);

// The step with which `steps` of them last for the duration, by a rounding longer, so that none is left over.
double step_of(const scenario::MachineScenario& scenario, double steps);

// The scenario with this method in place of its own.
scenario::MachineScenario with_method(scenario::MachineScenario scenario, const Method& method);

}  // namespace breakaway::sil
