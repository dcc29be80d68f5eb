// Intervals in sentences.
#pragma once

#include <string>

#include "breakaway/design/braked_kicks.hpp"
#include "breakaway/input/numbers.hpp"

namespace breakaway::design::detail {

inline std::string range(const Interval& interval, const std::string& unit) {
  return interval.least < interval.most ? "between " + brief(interval.least) + " and " + brief(interval.most) + unit
                                        : brief(interval.least) + unit;
}

}  // namespace breakaway::design::detail
