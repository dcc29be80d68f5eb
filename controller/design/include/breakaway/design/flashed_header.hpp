// The flashed configuration: from a certified design to the C++ header that the firmware is compiled with.
#pragma once

#include <string>

#include "breakaway/design/report.hpp"
#include "breakaway/law/flashed_axis.hpp"

namespace breakaway::design {

// The parameters with their table, limits and checksum. `parameters` are those of the axis that `report` is about; a
// force limit above the one that was certified is lowered to it. Refuses a design that is not certified, parameters
// that law::validate refuses, and a table that float cannot hold.
law::FlashedAxis<float> flashed_axis(law::AxisParameters<float> parameters, const AxisDesign& design,
                                     const DesignReport& report);

// The header: `inline constexpr breakaway::law::FlashedAxis<float> axis` in namespace breakaway::flashed, after a
// statement of what was certified and on which conditions. Numbers are hexadecimal, so that they are exact; the
// compiler checks the checksum. `source`: the file that the design was read from, for the statement.
std::string flashed_header(const law::FlashedAxis<float>& axis, const DesignReport& report, const std::string& source);

}  // namespace breakaway::design
