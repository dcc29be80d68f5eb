// The checks and the promise of the coast "work".
#pragma once

#include <string>
#include <vector>

#include "breakaway/design/report.hpp"
#include "breakaway/design/work_kicks.hpp"

namespace breakaway::design::detail {

// Requires axis.work with a spring_load.
std::vector<Check> work_checks(const AxisDesign& axis, const WorkDesign<float>& design);
WorkPromise work_promise(const AxisDesign& axis, const WorkDesign<float>& design);
std::vector<std::string> conditions_of_work(const AxisDesign& axis, const WorkPromise& promise);

}  // namespace breakaway::design::detail
