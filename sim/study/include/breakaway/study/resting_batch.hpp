// Seeded simulations of a certified machine: from random states inside { V < level } every motion has to come to rest.
#pragma once

#include <cstdint>
#include <optional>

#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::study {

struct RestingBatch {
  int trajectories = 0;
  int at_rest = 0;
  std::optional<stability::MachineState<Eigen::Dynamic>> not_at_rest;  // the first start that did not come to rest
};

// Starts are uniform in { V < level_J }, each followed for duration_s > 0 by the scenario's integrator, without the
// scenario's start and impulses. K has to be positive definite. Throws InputError as run_machine.
RestingBatch run_to_rest(scenario::MachineScenario scenario, double level_J, double duration_s, int trajectories,
                         std::uint64_t seed);

}  // namespace breakaway::study
