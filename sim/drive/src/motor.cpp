#include "breakaway/drive_emulator/motor.hpp"

#include <algorithm>
#include <cmath>

namespace breakaway::drive_emulator {

double Motor::clamped(double force_N) const { return std::clamp(force_N, -peak_force_N_, peak_force_N_); }

void Motor::command(double force_N, double time_s) {
  const double present_N = force_at_N(time_s);
  largest_so_far_N_ = largest_force_N(time_s);
  const double constant_N = clamped(force_N);
  segment_ = {.constant_N = constant_N,
              .transient_N = time_constant_s_ > 0 ? present_N - constant_N : 0,
              .time_constant_s = time_constant_s_,
              .start_s = time_s};
}

void Motor::limit_peak_force(double peak_force_N, double time_s) {
  largest_so_far_N_ = largest_force_N(time_s);
  peak_force_N_ = peak_force_N;
}

double Motor::largest_force_N(double time_s) const {
  // Each segment is monotonic, so its magnitude is largest at one of its ends.
  const double start_N = force_at_N(segment_.start_s);
  return std::max({largest_so_far_N_, std::abs(start_N), std::abs(force_at_N(time_s))});
}

std::int32_t encoder_counts(double position_m, double resolution_m) {
  constexpr double counter_range = 4294967296.0;
  const double wrapped = std::fmod(std::round(position_m / resolution_m), counter_range);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::int64_t>(wrapped)));
}

}  // namespace breakaway::drive_emulator
