// What a KickCoordinator is given: the axes of a machine whose kicks push the others, as certify_machine() of
// breakaway::stability certifies them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace breakaway::law {

// One axis of a machine. SI units; A, B and b as in Theorem S: least and greatest friction with all that acts beside
// it.
template <class Scalar, std::size_t Axes>
struct CoordinatedAxisParameters {
  Scalar position_gain_N_per_m{};   // P
  Scalar velocity_gain_Ns_per_m{};  // D
  Scalar mass_kg{};                 // the least that it may be, M_ii
  Scalar lower_N{};                 // A > brake_N
  Scalar upper_N{};                 // B >= A
  Scalar sure_N{};                  // > B, a force that is sure to move the axis
  Scalar brake_N{};                 // b >= 0
  Scalar kick_N{};                  // the most that a kick may have; 0: the axis is never kicked
  Scalar max_force_N{};
  Scalar gate_m{};       // a reading within it lets the release begin
  Scalar tolerance_m{};  // of the reading
  Scalar resolution_m{};
  std::array<Scalar, Axes> hold_off{};  // k_j for every axis j, while this one is kicked
};

// The first `count` of the axes are there.
template <class Scalar, std::size_t Axes>
struct CoordinatorParameters {
  Scalar period_s{};
  std::uint8_t count = Axes;
  std::uint8_t settling_periods = 2;  // from a force to a reading of what it has done: latency, and the current loops
  std::uint8_t still_periods = 8;
  std::uint16_t release_periods = 0;
  std::uint32_t most_kicks = 0;  // from one release to the hold
  std::array<CoordinatedAxisParameters<Scalar, Axes>, Axes> axes{};
};

namespace internal {

template <class Scalar>
constexpr bool is_within(Scalar value, Scalar least, Scalar most) noexcept {
  return value >= least && value <= most;
}

// The force that each other drive must give while this axis is kicked, for each unit of k: the most of pulse and coast.
template <class Scalar, std::size_t Axes>
constexpr Scalar largest_hold_off_N(const CoordinatedAxisParameters<Scalar, Axes>& a) noexcept {
  return std::max(a.kick_N - (a.lower_N + a.upper_N) / 2, (a.upper_N + a.brake_N) / 2);
}

template <class Scalar, std::size_t Axes>
constexpr bool is_usable(const CoordinatorParameters<Scalar, Axes>& p, std::size_t i) noexcept {
  constexpr Scalar most = std::numeric_limits<Scalar>::max(), least = std::numeric_limits<Scalar>::min();
  const auto& a = p.axes[i];
  const bool bounded = is_within(a.mass_kg, least, most) && is_within(a.brake_N, Scalar{0}, most) &&
                       a.lower_N > a.brake_N && is_within(a.upper_N, a.lower_N, most) &&
                       is_within(a.sure_N, a.upper_N, most) && is_within(a.max_force_N, least, most) &&
                       is_within(a.position_gain_N_per_m, Scalar{0}, most) &&
                       is_within(a.velocity_gain_Ns_per_m, Scalar{0}, most) && is_within(a.gate_m, least, most) &&
                       is_within(a.tolerance_m, least, most) && is_within(a.resolution_m, least, most);
  if (!bounded || !(is_within(a.kick_N, a.sure_N, a.max_force_N) || a.kick_N == 0)) return false;
  for (std::size_t j = 0; j < p.count; ++j) {
    const Scalar share = a.hold_off[j] < 0 ? -a.hold_off[j] : a.hold_off[j];
    // But for the rounding of the scalar type.
    const Scalar most_N = p.axes[j].max_force_N * (1 + 8 * std::numeric_limits<Scalar>::epsilon());
    if (!(j == i ? share <= 0 : share * largest_hold_off_N(a) <= most_N || a.kick_N == 0)) return false;
  }
  return true;
}

}  // namespace internal

// Whether all numbers are in their ranges, and every drive gives the forces that kicks of the others ask of it.
template <class Scalar, std::size_t Axes>
constexpr bool are_usable(const CoordinatorParameters<Scalar, Axes>& p) noexcept {
  const bool whole = p.period_s > 0 && p.period_s <= std::numeric_limits<Scalar>::max() && p.count >= 1 &&
                     p.count <= Axes && p.settling_periods >= 1 && p.still_periods >= 1;
  if (!whole) return false;
  for (std::size_t i = 0; i < p.count; ++i) {
    if (!internal::is_usable(p, i)) return false;
  }
  return true;
}

}  // namespace breakaway::law
