// The design report that an engineer signs: every check of one axis with its margin and source, the pictures that show
// how much room there is, and the conditions on which the verdict rests.
#pragma once

#include <string>

#include "breakaway/design/report.hpp"

namespace breakaway::report {

// `title` heads the page, `source` is the file that the axis was read from. Throws InputError when gnuplot
// cannot be run.
std::string design_html(const std::string& title, const std::string& source, const design::AxisDesign& axis,
                        const design::DesignReport& report);

}  // namespace breakaway::report
