// Records as text: what breakaway-node and breakaway identify write with --csv.
#pragma once

#include <limits>
#include <string>
#include <string_view>

#include "breakaway/evaluation/record.hpp"

namespace breakaway::evaluation {

// What the text does not say.
struct RecordUnits {
  double period_s = 0, resolution_m = 0, force_step_N = 0;
  double max_force_N = std::numeric_limits<double>::infinity();  // that the drive gives
  std::string axis{};  // only the lines with this name in a column `axis`, where there is one
};

// Reads the columns time_s, position_m and command_N, in any order and beside others. Up to 1000 periods that are
// missing in time_s become readings that are not fresh. Throws InputError naming the line, and where the record is of
// another period than units has.
Record record_of_csv(std::string_view text, const RecordUnits& units);

std::string to_csv(const Record& record);

}  // namespace breakaway::evaluation
