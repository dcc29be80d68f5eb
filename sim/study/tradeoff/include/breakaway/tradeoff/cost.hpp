// What a piece of work costs: instructions counted under valgrind where it is installed, and always the ratio of its
// time to that of another piece in the same run. A time alone would say more of the machine than of the method.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace breakaway::tradeoff {

inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

struct Cost {
  double instructions = not_measured;
  double time_ratio = not_measured;  // to the first work of its group
};

// prepare() makes all that is not to be measured and gives the work itself, which may be repeated.
struct Work {
  std::string name;  // unique in the program; without blanks and quotes
  std::function<std::function<void()>()> prepare;
  double units = 1;  // costs are given for one of them
};

struct Counting {
  std::string program;  // that runs `tradeoff --work NAME --repeat N` of itself; empty: instructions are not counted
  std::function<void(const std::string& what)> progress;
};

// One cost for each work. Times are the least of several, taken in turns.
std::vector<Cost> measure_costs(const std::vector<Work>& works, const Counting& counting);

// Whether valgrind can be run.
bool can_count();

// Keeps a result that nothing reads from being optimised away.
extern volatile double last_result;
inline void keep(double result) { last_result = result; }

}  // namespace breakaway::tradeoff
