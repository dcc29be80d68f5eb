// MotorDrive: what the control loop needs of a drive. Positive force pushes towards positive position.
//
// Positions come as an offset from a datum that the loop moves to the target: the drive subtracts whole encoder counts
// before it converts to metres, so a float near the target is exact to the count however far from zero the axis stands.
#pragma once

#include <concepts>
#include <cstdint>

#include "breakaway/hal/status.hpp"
#include "breakaway/hal/time.hpp"

namespace breakaway::hal {

enum class DriveState : std::uint8_t {
  configuring,  // being set up over the bus; no force
  disabled,     // set up, not energised; no force
  enabling,     // on the way to enabled; no force
  enabled,      // follows command()
  stopping,     // quick stop or fault reaction active
  fault,        // latched by the drive until reset_fault()
  unusable,     // cannot be used (wrong device, refused configuration); setup_status() says why
};

template <class Scalar>
struct DriveFeedback {
  DriveState state = DriveState::configuring;
  Scalar position_offset_m{};  // position minus datum
  Scalar position_m{};  // position from the drive's zero, rounded to Scalar: for limits and display, not for control
  Scalar force_N{};     // what the drive reports that it produces
  Time sample_time{};   // when the position was taken (time stamp of the frame that carried it, the drive's SYNC)
  bool fresh = false;   // a new position came since the last call
  bool ever_valid = false;       // any position came since power-up
  std::uint16_t fault_code = 0;  // 603Fh / EMCY error code while state is fault
};

// feedback: the newest sample; clears `fresh`.
// command: the force for the next period. Clamped to +-max_force_N; NaN counts as zero. Without a call in a period:
// zero force. set_datum_counts: the encoder count that position_offset_m is measured from. request_enable /
// request_stop / reset_fault: wishes; the drive's state machine carries them out in the following periods.
//   request_stop cannot fail and may be called in any state.
template <class D, class Scalar>
concept MotorDrive = requires(D& drive, const D& constant, Scalar force_N, std::int32_t counts) {
  { drive.feedback() }
  noexcept->std::same_as<DriveFeedback<Scalar>>;
  { drive.command(force_N) }
  noexcept->std::same_as<void>;
  { drive.set_datum_counts(counts) }
  noexcept->std::same_as<void>;
  { drive.request_enable() }
  noexcept->std::same_as<void>;
  { drive.request_stop() }
  noexcept->std::same_as<void>;
  { drive.reset_fault() }
  noexcept->std::same_as<void>;
  { constant.max_force_N() }
  noexcept->std::same_as<Scalar>;
  { constant.setup_status() }
  noexcept->std::same_as<Status>;
};

}  // namespace breakaway::hal
