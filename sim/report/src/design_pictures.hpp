// The pictures of the design report.
#pragma once

#include <vector>

#include "breakaway/design/report.hpp"
#include "pictures.hpp"

namespace breakaway::report {

std::vector<Picture> draw_design_pictures(const design::AxisDesign& axis, const design::DesignReport& report);

}  // namespace breakaway::report
