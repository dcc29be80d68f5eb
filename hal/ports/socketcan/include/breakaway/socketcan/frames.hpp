// Turns the frames of Linux (linux/can.h, linux/can/error.h) into ours and back.
#pragma once

#include <linux/can.h>

#include <optional>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/can_port.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::socketcan {

can_frame to_kernel(const hal::CanFrame& frame) noexcept;

// Returns nothing for an error frame or one with a 29-bit identifier.
std::optional<hal::CanFrame> from_kernel(const can_frame& frame) noexcept;

// ErrorReport: what an error frame says of the controller. Errors of single bits are left to the controller, which
// counts them and says when its state changes.
struct ErrorReport {
  std::optional<hal::BusState> state;
  bool overflow = false;  // the controller lost frames that were received or to be sent
};
ErrorReport error_report(const can_frame& frame) noexcept;

// Brings a time of CLOCK_REALTIME to CLOCK_MONOTONIC, given what both show now. A stamp that comes to lie in the future
// or before `earliest`, as after a step of the wall clock, becomes now.
hal::Time on_monotonic_clock(hal::Time stamp, hal::Time realtime_now, hal::Time monotonic_now,
                             hal::Time earliest) noexcept;

}  // namespace breakaway::socketcan
