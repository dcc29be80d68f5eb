// The parts of a scene that a user may leave out, one row each: to add one, add a row to scene_parts.cpp.
#pragma once

#include <string>
#include <vector>

#include "breakaway/scenario/machine_scenario.hpp"

namespace breakaway::tradeoff {

template <class AnyScenario>
struct ScenePart {
  std::string name;
  bool (*is_there)(const AnyScenario&);
  void (*leave_out)(AnyScenario&);
};

const std::vector<ScenePart<scenario::Scenario>>& axis_parts();
const std::vector<ScenePart<scenario::MachineScenario>>& machine_parts();

// Leaves the law alone on the bare plant: neither loop, drive nor bus.
void leave_out_the_loop(scenario::Scenario& scenario);

}  // namespace breakaway::tradeoff
