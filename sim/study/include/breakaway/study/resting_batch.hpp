// Seeded simulations of a certified machine: from random states inside { V < level } every motion has to come to rest.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::study {

struct RestingBatch {
  int trajectories = 0;
  int at_rest = 0;
  int on_their_way = 0;                                                // when their time was up, with less energy
  int refused = 0;                                                     // by the integrator, by name
  std::optional<stability::MachineState<Eigen::Dynamic>> not_at_rest;  // the first start that did neither
};

// Starts are uniform in { V < level_J }, each followed for duration_s > 0 by the scenario's integrator, without the
// scenario's start and impulses. K has to be positive definite. A motion that the integrator refuses is counted, and
// says nothing. `progress` is called with the share of the motions that are done. Throws InputError as run_machine, but
// for those refusals.
RestingBatch run_to_rest(scenario::MachineScenario scenario, double level_J, double duration_s, int trajectories,
                         std::uint64_t seed, const std::function<void(double share)>& progress = {});

}  // namespace breakaway::study
