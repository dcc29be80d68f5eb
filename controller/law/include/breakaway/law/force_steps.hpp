// Forces as whole steps of a drive, which take 16 bits on the bus.
#pragma once

#include <cmath>
#include <cstdint>

namespace breakaway::law {

inline constexpr std::int32_t most_force_steps = 32767;

// force_N >= 0, a limit: one that is a whole number of steps must not lose one to the rounding of the quotient.
template <class Scalar>
std::int32_t force_limit_steps(Scalar force_N, Scalar step_N) noexcept {
  const Scalar steps = force_N / step_N * (1 + Scalar(1e-6));
  return steps < Scalar(most_force_steps) ? static_cast<std::int32_t>(steps) : most_force_steps;
}

// Rounds down, within most_force_steps either way. NaN becomes zero, because a force that nobody computed must not act.
template <class Scalar>
std::int32_t whole_force_steps(Scalar force_N, Scalar step_N) noexcept {
  const Scalar steps = force_N / step_N;
  if (!(std::abs(steps) < Scalar(most_force_steps))) {
    if (steps > 0) return most_force_steps;
    return steps < 0 ? -most_force_steps : 0;
  }
  const auto truncated = static_cast<std::int32_t>(steps);
  return static_cast<Scalar>(truncated) > steps ? truncated - 1 : truncated;
}

}  // namespace breakaway::law
