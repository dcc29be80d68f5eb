// Motor: what is behind the drive's torque command, with its physical limit and the lag of its current loop. Beside it,
// the encoder on its axis.
#pragma once

#include <cstdint>

#include "breakaway/model/applied_force.hpp"

namespace breakaway::drive_emulator {

class Motor {
 public:
  // peak_force_N > 0; time_constant_s >= 0. With a time constant of 0 the force follows at once.
  Motor(double peak_force_N, double time_constant_s) : peak_force_N_(peak_force_N), time_constant_s_(time_constant_s) {}

  // Returns the force inside +-peak_force_N that is nearest.
  double clamped(double force_N) const;
  double commanded_N() const { return segment_.constant_N; }

  // Has the force tend to clamped(force_N) from time_s on, starting from what it is then.
  void command(double force_N, double time_s);

  const model::AppliedForce& segment() const { return segment_; }
  // The sum of the two terms is clamped, because it may round to one unit beyond the limit that both keep.
  double force_at_N(double time_s) const { return clamped(segment_.constant_N + segment_.transient_at_N(time_s)); }
  // Returns the largest |force| from the beginning until time_s.
  double largest_force_N(double time_s) const;
  double peak_force_N() const { return peak_force_N_; }
  // From time_s on; > 0.
  void limit_peak_force(double peak_force_N, double time_s);

 private:
  double peak_force_N_;
  double time_constant_s_;
  model::AppliedForce segment_{};
  double largest_so_far_N_ = 0;
};

// Returns the count nearest to position_m / resolution_m, in a 32-bit counter that wraps around.
std::int32_t encoder_counts(double position_m, double resolution_m);

}  // namespace breakaway::drive_emulator
