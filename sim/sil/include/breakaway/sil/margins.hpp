// How much of each limit of an axis a run left.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

struct Margin {
  const char* name;  // with its unit: position_m, speed_m_s, force_N
  const char* unit;
  double left;  // below 0 where the limit was passed
};

// That the axis may be given at most, in newtons that act on it: its limits are of the force that its node is told it
// commands.
double most_true_N(const config::Axis& axis);

// Of [limits] position and speed, as far as the file states them, and of that force.
std::vector<Margin> margins(const config::Axis& axis, const Excursions& excursions, double max_force_N);

// "position 0.1 m, speed 2.4 m/s, force 0 N"
std::string to_text(const std::vector<Margin>& margins);

}  // namespace breakaway::sil
