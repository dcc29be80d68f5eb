// Record: what a loop read and commanded, period by period.
#pragma once

#include <cstddef>
#include <vector>

namespace breakaway::evaluation {

struct Reading {
  double position_m = 0;
  double command_N = 0;  // computed in this period, from this position or from it and earlier ones
  bool fresh = true;     // false: no sample came, and the position is an older one
};

struct Record {
  double period_s = 0;
  double resolution_m = 0;  // one count
  double force_step_N = 0;  // of the drive
  std::vector<Reading> readings;
};

}  // namespace breakaway::evaluation
