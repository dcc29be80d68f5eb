// What a ControlLoop says of an axis: why it was not taken in, and what it did in the last step.
#pragma once

#include <cstdint>
#include <string_view>

#include "breakaway/firmware/supervisor.hpp"
#include "breakaway/hal/motor_drive.hpp"
#include "breakaway/law/control_types.hpp"

namespace breakaway::firmware {

// Says why an axis is not taken into a loop.
enum class AxisError : std::uint8_t {
  none,
  no_room,
  period_differs,
  node_id_taken,
};

constexpr std::string_view to_string(AxisError error) noexcept {
  switch (error) {
    case AxisError::none:
      return "the axis is in the loop";
    case AxisError::no_room:
      return "the loop has no room for another axis: raise MaxAxes";
    case AxisError::period_differs:
      return "the controller was designed for another period than the loop's: design it again for this one";
    case AxisError::node_id_taken:
      return "the drive's node id is that of another drive or of the loop itself: give each its own";
  }
  return "unknown axis error";
}

// Says what one axis did in the last step, for logs and displays.
template <class Scalar>
struct AxisStatus {
  hal::DriveFeedback<Scalar> feedback{};
  law::ControlOutput<Scalar> output{};
  AxisFault fault = AxisFault::none;
  bool stop_not_obeyed = false;  // since the last reset; `fault` is what came first
  bool running = false;          // enabled and under control
};

}  // namespace breakaway::firmware
