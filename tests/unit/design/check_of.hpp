// The checks of a report by their names.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>

#include "breakaway/design/report.hpp"

namespace breakaway::testing {

inline bool has_check(const design::DesignReport& report, const std::string& name) {
  return std::ranges::find(report.checks, name, &design::Check::name) != report.checks.end();
}

// Throws where the report has none of this name, which ends its test.
inline design::Check check_of(const design::DesignReport& report, const std::string& name) {
  const auto found = std::ranges::find(report.checks, name, &design::Check::name);
  if (found == report.checks.end()) throw std::out_of_range{"the report has no check " + name};
  return *found;
}

}  // namespace breakaway::testing
