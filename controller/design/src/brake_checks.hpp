// The checks of a certificate of the coast "brake".
#pragma once

#include <vector>

#include "breakaway/design/report.hpp"

namespace breakaway::design::detail {

// All of them, for an axis with `braked`: of the kicks and the approach, and of what else is stated of it.
std::vector<Check> brake_checks(const AxisDesign& axis, const BrakedDesign<float>& design);

}  // namespace breakaway::design::detail
