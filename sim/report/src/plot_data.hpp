// Numbers as gnuplot reads them.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "thin.hpp"

namespace breakaway::report {

inline std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.10g}", value) : "NaN"; }

// A gnuplot data block `$name`, one row an entry.
template <class Range, class Row>
std::string data(std::string_view name, const Range& entries, Row row) {
  std::string text = fmt::format("${} << END\n", name);
  for (const auto& entry : entries) {
    std::string separator;
    for (const double value : row(entry)) text += std::exchange(separator, " ") + number(value);
    text += '\n';
  }
  return text + "END\n";
}

inline std::string data(std::string_view name, const std::vector<Point>& points) {
  return data(name, points, [](const Point& p) { return std::array{p.x, p.y}; });
}

}  // namespace breakaway::report
