// EmulatedDrive: what a simulated network asks of a drive emulator, whatever protocol it speaks.
#pragma once

#include <optional>

#include "breakaway/hal/can_frame.hpp"
#include "breakaway/hal/time.hpp"
#include "breakaway/model/applied_force.hpp"

namespace breakaway::drive_emulator {

// Time enters by these calls only and must never decrease.
class EmulatedDrive {
 public:
  virtual ~EmulatedDrive() = default;

  virtual void power_on(hal::Time time) = 0;
  // From here on there are no frames and no torque, and everything is forgotten.
  virtual void power_off(hal::Time time) = 0;
  // time: when the frame's last bit was on the wire.
  virtual void on_frame(const hal::CanFrame& frame, hal::Time time) = 0;
  // Runs everything that is due up to and including `time`.
  virtual void advance_to(hal::Time time) = 0;
  // Returns when advance_to has something to do next; nothing while it has not.
  virtual std::optional<hal::Time> next_event() const = 0;
  // Brings the mechanism forward as well, for a look at it between two events.
  virtual void advance_mechanism_to(hal::Time time) = 0;
  // What is true of the force, whatever the bus says.
  virtual const model::AppliedForce& force() const = 0;
  // Returns the largest magnitude of the force from the beginning until `end`.
  virtual double largest_force_N(hal::Time end) const = 0;
};

}  // namespace breakaway::drive_emulator
