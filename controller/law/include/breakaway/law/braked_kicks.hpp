// BrakedKicks: what the law needs for the coast "brake", worked out and certified on a PC.
//
// Forces here are as they are commanded. What the drive makes of them, and how far mass, friction and lag may be off,
// is in the numbers already; the control loop takes them as they are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "breakaway/law/kick_table.hpp"
#include "breakaway/law/move_plan.hpp"

namespace breakaway::law {

// So many times as far away as the brake takes over may the last approach that the law tries leave an axis: behind a
// latency one from rest ends where the axis is expected to be under its least friction.
inline constexpr double left_beyond = 1.01;

// Of BrakedApproach::switch_speed_m_s, at which the brake takes over at most.
inline constexpr double most_taken_over = 1.25;

// How the axis is brought near the target before the first kick: down the speed w at the distance E from the point
// aimed at with w^2 = 2 a E, hard while E is large and with the brake alone at the end.
template <class Scalar>
struct BrakedApproach {
  Scalar mass_kg{};            // as told
  Scalar friction_N{};         // helps to stop: the least there is
  Scalar hard_m_s2{};          // deceleration far away, of which the drive is capable for certain
  Scalar gentle_m_s2{};        // deceleration by brake and least friction
  Scalar switch_speed_m_s{};   // below it the brake alone stops the axis
  Scalar switch_distance_m{};  // within which it does
  Scalar short_of_target_m{};  // the point aimed at is so far before the target
  Scalar response_s{};         // in which the loop is to mend a speed that is off: a period, and more with lag
  Scalar lag_s{};              // of the current loop
  Scalar correction{};         // share of a reading's surprise that the estimated speed takes over, in (0, 1]
  Scalar standing_m_s{};       // an estimated speed up to this may be that of noise; without noise 0
  MoveLimits<Scalar> move{};
};

// Friction that is a spring before it slides. All is 0 for friction that holds at once.
template <class Scalar>
struct FrictionSpring {
  Scalar reach_m{};                   // within which an axis at rest is led by a force that is kept
  Scalar step_m{};                    // by which a step of that force moves the axis at most
  Scalar most_N{};                    // of that force, below the least friction
  Scalar gain_N_per_m{};              // by which it grows in a period, per distance to the target
  Scalar share{};                     // of a reading that the distance is taken from, the rest being of those before
  std::uint16_t longest_periods = 0;  // that the force may grow and fall
  std::uint16_t ringing_periods = 0;  // twice as long as until the axis rings by half a count at most

  constexpr bool is_there() const noexcept { return reach_m > 0; }
  // Written so that a NaN is refused.
  constexpr bool is_usable(Scalar held_N) const noexcept {
    return reach_m >= 0 && share >= 0 && share <= 1 &&
           (!is_there() || (step_m >= 0 && most_N > 0 && most_N <= held_N && gain_N_per_m > 0));
  }
};

// How far a kick from a reading outside the tolerance is sure to lead an axis on: a line below what the pulses of the
// table travel at least.
template <class Scalar>
struct SureTravel {
  Scalar share{};   // 0: nothing is sure
  Scalar from_m{};  // where the line is at nothing
  Scalar most_m{};  // from further away a kick is sure of no more than from here

  constexpr Scalar from(Scalar reading_m) const noexcept { return share * (std::min(reading_m, most_m) - from_m); }
  // Written so that a NaN is refused.
  constexpr bool is_usable() const noexcept { return share >= 0 && share <= 1 && from_m <= most_m; }
};

template <class Scalar>
struct BrakedKicks {
  Scalar brake_N{};          // b: with the largest force gain it is below the least friction
  Scalar force_step_N{};     // of the drive; every force is a whole number of steps
  Scalar preload_N{};        // a pulse starts when the force is sure to be at least this, and at most the brake
  Scalar resting_force_N{};  // theta: after a kick, an axis seen still is at rest only under a force of at most this
  Scalar holding_force_N{};  // an axis at rest stays there under this force, either way, for certain
  Scalar fast_lag{};         // e^(-T/tau): share of a change of force that is left after a period, at least ...
  Scalar slow_lag{};         // ... and at most
  Scalar short_lag{};        // of the fastest current loop after the shortest period; without jitter that is fast_lag
  Scalar coast_per_N{};      // longest lawful coast, as a multiple of the pulse, per newton of its force
  Scalar breakaway_N{};      // as commanded: a greater force moves the axis for certain
  Scalar lost_motion_m{};    // that a spring may take up while the axis moves, and the encoder shows nothing
  Scalar least_seen_N{};     // that friction_seen_N() gives for the kicks of a lawful axis,
  Scalar most_seen_N{};      // and the most; the largest number where springs make kicks show nothing of friction
  std::uint16_t still_periods = 0;       // without a change of count that prove rest under theta
  std::uint16_t either_way_periods = 0;  // the same under holding_force_N, where the axis may move either way
  std::uint16_t patient_periods = 0;   // the same under any force: a proof of nothing, but there is no more to wait for
  std::uint16_t settling_periods = 0;  // in which the slowest current loop follows a change
  Scalar fine_floor_m{};               // below it FineStage kicks; 0: the table does everywhere
  SureTravel<Scalar> sure{};
  FrictionSpring<Scalar> spring{};
  BrakedApproach<Scalar> approach{};
  KickTable<Scalar> table{};

  // How near a hold is promised to be where this is asked: a fine stage aims nearer than its floor.
  constexpr Scalar promised_m(Scalar asked_m) const noexcept { return std::max(asked_m, fine_floor_m); }
  constexpr bool kicks_show_friction() const noexcept { return most_seen_N < std::numeric_limits<Scalar>::max(); }
  // The distance at which an approach gives way to brake and kicks.
  constexpr Scalar hand_over_m() const noexcept { return approach.switch_distance_m + approach.short_of_target_m; }
  // Kicks can lead an axis back from there.
  [[gnu::cold, gnu::noinline]] constexpr Scalar led_back_m() const noexcept {
    return std::max(table.reach_m(), hand_over_m());
  }
  // An axis that rests further away is approached, and kicked from there only where that does not help: kicks keep none
  // of the limits of a move.
  constexpr Scalar begin_m() const noexcept {
    return approach.move.are_asked_for() ? Scalar(left_beyond) * hand_over_m() : led_back_m();
  }
};

// The constant friction under which an axis of this mass, without lag, would move by travel_m >= 0 in a kick: in a
// pulse of pulse_s it gains the speed that it loses again under friction and brake. It falls as the travel grows.
template <class Scalar>
constexpr Scalar friction_seen_N(Scalar mass_kg, Scalar force_N, Scalar brake_N, Scalar pulse_s,
                                 Scalar travel_m) noexcept {
  const Scalar both_N = force_N + brake_N, gain = both_N * pulse_s * pulse_s;
  return both_N * gain / (2 * mass_kg * travel_m + gain) - brake_N;
}

// The other way round: the travel under this friction, which must be more than -brake_N; less than nothing where the
// force is too weak for it.
template <class Scalar>
constexpr Scalar travel_seen_m(Scalar mass_kg, Scalar force_N, Scalar brake_N, Scalar pulse_s,
                               Scalar friction_N) noexcept {
  const Scalar gain = (force_N + brake_N) * pulse_s * pulse_s;
  return gain * (force_N - friction_N) / (2 * mass_kg * (friction_N + brake_N));
}

// Says whether the numbers can be those of an axis; written so that a NaN is refused.
template <class Scalar>
[[gnu::cold]] constexpr bool are_usable(const BrakedKicks<Scalar>& k) noexcept {
  const BrakedApproach<Scalar>& a = k.approach;
  const bool lags = k.fast_lag >= 0 && k.fast_lag <= k.short_lag && k.short_lag <= k.slow_lag && k.slow_lag < 1;
  const bool forces = k.brake_N >= 0 && k.force_step_N > 0 && k.preload_N <= k.brake_N &&
                      k.resting_force_N >= -k.brake_N && k.holding_force_N >= k.brake_N &&
                      k.breakaway_N > k.holding_force_N && k.lost_motion_m >= 0 && k.least_seen_N < k.most_seen_N;
  const bool waits = k.still_periods > 0 && k.either_way_periods > 0 && k.patient_periods > 0;
  const bool approach = a.mass_kg > 0 && a.friction_N > 0 && a.hard_m_s2 > 0 && a.gentle_m_s2 > 0 &&
                        a.switch_speed_m_s > 0 && a.switch_distance_m > 0 && a.short_of_target_m >= 0 &&
                        a.response_s > 0 && a.lag_s >= 0 && a.correction > 0 && a.correction <= 1 &&
                        a.standing_m_s >= 0 && a.move.are_usable();
  return lags && forces && waits && approach && k.sure.is_usable() && k.spring.is_usable(a.friction_N) &&
         k.fine_floor_m >= 0 && k.coast_per_N > 0 && k.table.is_usable();
}

}  // namespace breakaway::law
