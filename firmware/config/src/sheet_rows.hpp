// [drive] eds: the rows of a drive that its maker's data sheet may stand in for.
#pragma once

#include "breakaway/config/node.hpp"
#include "breakaway/config/toml_section.hpp"

namespace breakaway::config {

// Reads the sheet. `section` and `drive` must outlive the row.
Key sheet_row(Drive& drive);

// Takes what the file leaves out from the sheet. Throws InputError for what neither has.
void take_from_sheet(const Section& section, Drive& drive);

}  // namespace breakaway::config
