// HomingConfig: how an axis with an incremental encoder gets its zero.
#pragma once

#include <chrono>
#include <cstdint>

#include "breakaway/hal/time.hpp"

namespace breakaway::cia402 {

// An axis gets its zero when it is enabled for the first time, and after a reset that acknowledges that it was lost.
enum class Home : std::uint8_t {
  none,      // it counts as the drive does, until somebody says where it stands
  here,      // it stands at home
  by_drive,  // the drive finds its home by itself, in the mode "homing" (CiA 402-2)
};

struct HomingConfig {
  Home home = Home::none;
  std::int32_t position_counts = 0;  // of home, in the axis' direction: 607Ch of a drive that finds it by itself
  // The rest is for `by_drive`.
  std::int8_t method = 37;                   // 6098h; 35 and 37: the axis stands at home
  std::uint32_t search_counts_s = 0;         // 6099h:01, speed while it looks for a switch; 0: the drive's own
  std::uint32_t zero_counts_s = 0;           // 6099h:02, speed while it looks for zero; 0: the drive's own
  std::uint32_t acceleration_counts_s2 = 0;  // 609Ah; 0: the drive's own
  hal::Duration timeout = std::chrono::seconds{60};
};

}  // namespace breakaway::cia402
