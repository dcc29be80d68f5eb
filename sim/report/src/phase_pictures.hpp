// The plane of position and velocity: the whole run, and its end.
#pragma once

#include <vector>

#include "breakaway/config/node.hpp"
#include "breakaway/sil/result.hpp"
#include "pictures.hpp"

namespace breakaway::report {

// The whole, and what happens near the last target where the whole does not show it. Requires a recorded trace.
std::vector<Picture> draw_phase_planes(const config::Axis& axis, double tolerance_m, const sil::AxisResult& result);

}  // namespace breakaway::report
