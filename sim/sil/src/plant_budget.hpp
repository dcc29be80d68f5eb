// What the motion of a scenario's axes may cost in one run, and what its refusal names.
#pragma once

#include "breakaway/motion/work_budget.hpp"
#include "breakaway/scenario/scenario.hpp"

namespace breakaway::sil {

// Requires a [run].
motion::WorkBudget plant_budget(const scenario::Scenario& scenario);

}  // namespace breakaway::sil
