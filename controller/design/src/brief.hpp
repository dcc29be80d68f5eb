// Numbers in sentences.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include "breakaway/design/braked_kicks.hpp"

namespace breakaway::design::detail {

// People read six digits.
inline std::string brief(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

inline std::string range(const Interval& interval, const std::string& unit) {
  return interval.least < interval.most ? "between " + brief(interval.least) + " and " + brief(interval.most) + unit
                                        : brief(interval.least) + unit;
}

}  // namespace breakaway::design::detail
