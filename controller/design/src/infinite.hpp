#pragma once

#include <limits>

namespace breakaway::design {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace breakaway::design
