// A first file for an axis of which seven numbers are known.
#pragma once

#include <string>

#include "breakaway/config/node.hpp"
#include "breakaway/design/report.hpp"

namespace breakaway::config {

// All must be above 0 and in the range of what they are written to, friction_lower_N below friction_upper_N below
// max_force_N, and the rate one that drives can be told.
struct KnownAxis {
  double mass_kg = 0;
  double friction_lower_N = 0;  // bounds of dry friction at any place, speed and time
  double friction_upper_N = 0;
  double encoder_resolution_m = 0;  // one count
  double rate_Hz = 0;               // of the control loop
  double max_force_N = 0;           // of the drive
  double longest_move_m = 0;
};

struct NewNode {
  std::string text;             // of the file
  Node node;                    // that it describes
  design::DesignReport report;  // of its one axis
};

// Throws InputError, with the remedy, where the numbers that are not 0 forbid a file already: out of range, in
// contradiction, a rate that no drive can be told, a travel that 32 bits do not count.
void require_possible_so_far(const KnownAxis& known);

// Writes a file with a comment on each number: what was known, and where it was not, a value to begin with. The
// tolerance is the least that is certified, rounded up to two digits. Throws InputError where a number is outside its
// range, where no tolerance can be certified, with the reason, and as read_node() does.
NewNode new_node(const KnownAxis& known);

}  // namespace breakaway::config
