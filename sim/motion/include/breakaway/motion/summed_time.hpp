// The time that a simulation has reached, as the sum of all the durations that have passed.
#pragma once

namespace breakaway::motion {

// The exact time is sum_s + compensation_s: what the sum loses to rounding is carried along (Kahan's summation), so
// that a thousand short flights end when they should.
struct SummedTime {
  double sum_s = 0;
  double compensation_s = 0;

  void pass(double duration_s) {
    const double step_s = duration_s + compensation_s, next_s = sum_s + step_s;
    compensation_s = step_s - (next_s - sum_s);
    sum_s = next_s;
  }
  // These return the instant that lies this far ahead, and how far ahead an instant lies.
  double after(double duration_s) const { return sum_s + (compensation_s + duration_s); }
  double until(double time_s) const { return (time_s - sum_s) - compensation_s; }

  bool operator==(const SummedTime&) const = default;
};

}  // namespace breakaway::motion
