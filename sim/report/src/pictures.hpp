// The pictures of the report.
#pragma once

#include <string>
#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/sil/result.hpp"

namespace breakaway::report {

struct Picture {
  std::string title;
  std::string caption;
  std::string svg;
};

// The pictures of an axis for which its recorded result holds something to see; none of one that never left its set-up.
std::vector<Picture> draw_pictures(const config::Node& node, const config::Axis& axis, const sil::AxisResult& result);

// The bus is shared by all axes. Requires a recorded trace and result.loop.
Picture draw_bus_load(const sil::Result& result);

}  // namespace breakaway::report
