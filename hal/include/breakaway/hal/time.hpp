// Time as every room of the hal and the firmware counts it: signed nanoseconds since an epoch that the clock chooses.
#pragma once

#include <chrono>

namespace breakaway::hal {

using Time = std::chrono::nanoseconds;      // a point in time: nanoseconds since the clock's epoch
using Duration = std::chrono::nanoseconds;  // a difference of two

}  // namespace breakaway::hal
