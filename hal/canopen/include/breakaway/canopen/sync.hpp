// SYNC (CiA 301, 7.2.5): the frame at which every synchronous PDO acts. The network's producer sends it once a period.
#pragma once

#include "breakaway/canopen/cob_id.hpp"
#include "breakaway/hal/can_frame.hpp"

namespace breakaway::canopen {

// The frame has no counter, which is optional (1019h = 0).
constexpr hal::CanFrame sync_frame() noexcept { return {.id = sync_cob_id, .size = 0, .remote = false, .data = {}}; }

constexpr bool is_sync(const hal::CanFrame& frame) noexcept { return frame.id == sync_cob_id && !frame.remote; }

}  // namespace breakaway::canopen
