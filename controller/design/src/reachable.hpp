// What a tolerance that no certificate can promise would take.
#pragma once

#include <string>

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design::detail {

// The true error at rest that is promised where readings within this tolerance are reached.
double error_at_rest_m(const BrakedClass& axes, double reached_m);

// In words and numbers, each of which makes the tolerance reachable, all else being equal: a tolerance, a period, and
// an error up to which the fine stage may fall short of it; or, where no reading tells the tolerance, a count of the
// encoder. What does not make it reachable by itself is left out.
std::string ways_to_reach(const BrakedClass& axes, const BrakedDesign<float>& design, double tolerance_m,
                          double least_period_s);

}  // namespace breakaway::design::detail
