// The motor behind the drive's torque command: physical limit and current-loop lag; and the encoder on its axis.
#pragma once

#include <cstdint>

#include "breakaway/model/applied_force.hpp"

namespace breakaway::drive_emulator {

class Motor {
 public:
  // peak_force_N > 0; time_constant_s >= 0, 0: the force follows at once.
  Motor(double peak_force_N, double time_constant_s) : peak_force_N_(peak_force_N), time_constant_s_(time_constant_s) {}

  double clamped(double force_N) const;  // to +-peak_force_N
  double commanded_N() const { return segment_.constant_N; }

  // From time_s on the force tends to clamped(force_N), starting from what it is then.
  void command(double force_N, double time_s);

  const model::AppliedForce& segment() const { return segment_; }
  // Clamped, because the sum of the two terms may round to one unit beyond the limit that both keep.
  double force_at_N(double time_s) const { return clamped(segment_.constant_N + segment_.transient_at_N(time_s)); }
  double largest_force_N(double time_s) const;  // largest |force| from the beginning until time_s
  double peak_force_N() const { return peak_force_N_; }

 private:
  double peak_force_N_;
  double time_constant_s_;
  model::AppliedForce segment_{};
  double largest_so_far_N_ = 0;
};

// The count nearest to position_m / resolution_m, in a 32-bit counter that wraps around.
std::int32_t encoder_counts(double position_m, double resolution_m);

}  // namespace breakaway::drive_emulator
