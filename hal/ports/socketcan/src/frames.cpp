#include "breakaway/socketcan/frames.hpp"

#include <linux/can/error.h>

#include <algorithm>

namespace breakaway::socketcan {

can_frame to_kernel(const hal::CanFrame& frame) noexcept {
  can_frame kernel_frame{};
  kernel_frame.can_id = frame.id | (frame.remote ? CAN_RTR_FLAG : 0U);
  kernel_frame.can_dlc = frame.size;
  if (!frame.remote) std::ranges::copy(frame.payload(), kernel_frame.data);
  return kernel_frame;
}

std::optional<hal::CanFrame> from_kernel(const can_frame& frame) noexcept {
  if ((frame.can_id & (CAN_ERR_FLAG | CAN_EFF_FLAG)) != 0) return {};
  hal::CanFrame received{.id = static_cast<std::uint16_t>(frame.can_id & CAN_SFF_MASK),
                         .size = std::min<std::uint8_t>(frame.can_dlc, CAN_MAX_DLEN),
                         .remote = (frame.can_id & CAN_RTR_FLAG) != 0,
                         .data = {}};
  if (!received.remote) std::copy_n(frame.data, received.size, received.data.begin());
  return received;
}

ErrorReport error_report(const can_frame& frame) noexcept {
  constexpr unsigned overflow = CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW;
  constexpr unsigned passive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
  constexpr unsigned warning = CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING;
  if ((frame.can_id & CAN_ERR_FLAG) == 0) return {};
  if ((frame.can_id & CAN_ERR_BUSOFF) != 0) return {.state = hal::BusState::bus_off};
  ErrorReport report;
  if ((frame.can_id & CAN_ERR_RESTARTED) != 0) report.state = hal::BusState::error_active;
  if ((frame.can_id & CAN_ERR_CRTL) == 0) return report;
  const unsigned details = frame.data[1];
  report.overflow = (details & overflow) != 0;
  if ((details & CAN_ERR_CRTL_ACTIVE) != 0) report.state = hal::BusState::error_active;
  if ((details & warning) != 0) report.state = hal::BusState::error_warning;
  if ((details & passive) != 0) report.state = hal::BusState::error_passive;
  return report;
}

hal::Time on_monotonic_clock(hal::Time stamp, hal::Time realtime_now, hal::Time monotonic_now,
                             hal::Time earliest) noexcept {
  const hal::Duration age = realtime_now - stamp;
  const bool plausible = age >= hal::Duration::zero() && age <= monotonic_now - earliest;
  return plausible ? monotonic_now - age : monotonic_now;
}

}  // namespace breakaway::socketcan
