// The design report that an engineer signs: of each axis every check with its margin and source, the pictures that show
// how much room there is, and the conditions on which the verdict rests.
#pragma once

#include <string>
#include <vector>

#include "breakaway/design/report.hpp"

namespace breakaway::report {

struct DesignedAxis {
  std::string name;
  design::AxisDesign design;
  design::DesignReport report;
};

// `title` heads the page, `source` is the file that the axes were read from; at least one axis. Throws InputError when
// gnuplot cannot be run.
std::string design_html(const std::string& title, const std::string& source, const std::vector<DesignedAxis>& axes);

}  // namespace breakaway::report
