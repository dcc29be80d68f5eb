#pragma once

#include <limits>

namespace breakaway::stability {

inline constexpr double infinite = std::numeric_limits<double>::infinity();

}  // namespace breakaway::stability
