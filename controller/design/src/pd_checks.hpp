// The checks of a certificate of the coast "pd": what [I] assumes, and what its sampled loop needs.
#pragma once

#include <vector>

#include "breakaway/design/report.hpp"

namespace breakaway::design::detail {

// Of a report whose figures of [I] and of the k3 table are there.
std::vector<Check> pd_checks(const AxisDesign& axis, const DesignReport& report);

// What the trial of an axis shows for which all of these hold.
Check tried_check(const PdPromise& pd);
Check near_end_check(const DesignReport& report, const PdPromise& pd);
Check few_kicks_check(const PdPromise& pd);

}  // namespace breakaway::design::detail
