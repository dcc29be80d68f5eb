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

// Of [limits] position and speed, as far as the file states them, and of the force that the axis may be given.
std::vector<Margin> margins(const config::Axis& axis, const Excursions& excursions, double max_force_N);

// "position 0.1 m, speed 2.4 m/s, force 0 N"
std::string to_text(const std::vector<Margin>& margins);

}  // namespace breakaway::sil
