// Mechanism: what a drive's force acts on and its encoder sits on.
#pragma once

#include "breakaway/model/applied_force.hpp"

namespace breakaway::drive_emulator {

// The drive fills constant_N and the transient only: a held command, and a current loop that settles on it.
class Mechanism {
 public:
  // Moves on to time_s under `force`, which has held since the time of the last call. time_s never decreases.
  virtual void advance_to(double time_s, const model::AppliedForce& force) = 0;
  virtual double position_m() const = 0;
  // Tells a new force at the instant from which it holds, right after advance_to() with the one before. What several
  // drives push needs to know, because any of them may move it on.
  virtual void change_force(const model::AppliedForce& /*force*/) {}

 protected:
  ~Mechanism() = default;
};

}  // namespace breakaway::drive_emulator
