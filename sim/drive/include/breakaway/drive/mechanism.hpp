// What a drive's force acts on, and what its encoder sits on.
#pragma once

#include <cmath>

namespace breakaway::drive {

// The force from start_s until the next segment: steady_N + transient_N exp(-(t - start_s) / time_constant_s), the
// answer of a first-order current loop to a step. An ideal loop has time_constant_s = 0 and transient_N = 0.
struct ForceSegment {
  double steady_N = 0;
  double transient_N = 0;
  double time_constant_s = 0;
  double start_s = 0;

  double at(double time_s) const {
    if (transient_N == 0) return steady_N;
    return steady_N + transient_N * std::exp(-(time_s - start_s) / time_constant_s);
  }
};

class Mechanism {
 public:
  // Moves on to time_s under `force`, which holds since the time of the last call. time_s never decreases.
  virtual void advance_to(double time_s, const ForceSegment& force) = 0;
  virtual double position_m() const = 0;

 protected:
  ~Mechanism() = default;
};

}  // namespace breakaway::drive
