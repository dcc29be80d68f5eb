// MovesEnd says whether axes whose targets move at once arrive at once.
#pragma once

#include <cstdint>

namespace breakaway::firmware {

enum class MovesEnd : std::uint8_t {
  each,      // as soon as each axis can
  together,  // axes with limits of a move go as slowly as the slowest of those that set off in the same period
};

}  // namespace breakaway::firmware
