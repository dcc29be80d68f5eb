// WorkKicks: what the law needs for the coast "work", worked out and certified on a PC.
//
// Motor and load are two masses on a spring. From rest, under friction of at least A1 and A2 on them and a drive that
// gives F while the motor travels D1 and nothing afterwards, the work F D1 goes into friction, the spring and speed:
//   A1 |d1| + A2 |d2| <= F D1 + what the spring gives back,
// whatever the masses. So a pulse that ends while F D1 <= (A1 + A2) (y - eps) leads neither of them further than y,
// where eps is what the spring may add to the encoder's side. controller/design/THEORY.md has the proof.
#pragma once

#include <cstdint>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/kick_table.hpp"

namespace breakaway::law {

// A move whose acceleration is the mean of a rectangular plan over a whole period of the resonance, so that it leaves
// nothing swinging, followed by a feedback too slow to excite anything.
template <class Scalar>
struct ShapedApproach {
  Scalar mass_kg{};            // of both
  Scalar friction_N{};         // the middle of what there is, fed forward while the plan moves
  Scalar acceleration_m_s2{};  // of the plan, at most
  Scalar stiffness_N_per_m{};  // of the feedback
  Scalar damping_Ns_per_m{};
  Scalar short_of_target_m{};      // the plan ends so far before the target
  Scalar begin_m{};                // an axis that rests further away is approached, not kicked
  std::uint8_t swing_periods = 1;  // a period of the resonance, over which the plan is averaged
  std::uint8_t speed_periods = 1;  // over which the speed is read
  std::uint8_t mean_periods = 0;   // the place is the mean of two readings so far apart
};

template <class Scalar>
struct WorkKicks {
  Scalar force_step_N{};         // of the drive; every force is a whole number of steps
  Scalar slow_lag{};             // of the current loop: share of a change of force that is left after a period
  Scalar breakaway_N{};          // as commanded: a greater force moves both masses for certain
  Scalar lost_motion_m{};        // that the spring may take up while they move, and the encoder shows nothing
  Scalar spring_m{};             // eps: what the spring may add to a kick
  Scalar creep_m{};              // of the tolerance, kept for what the spring may move a held axis by
  Scalar friction_per_gain_N{};  // A1 + A2, by the largest force gain: F D1 of a lawful pulse is at most this (y - eps)
  Scalar speeding_s_per_kg{};    // greatest gain over the least motor mass, times a period
  Scalar held_back_N{};          // as commanded: so much of a pulse does not speed the motor up
  Scalar late_periods{};         // from taking a sample until the force of the next period has ended
  std::uint16_t still_periods = 0;          // without a change of count that prove rest
  std::uint16_t patient_periods = 0;        // the same in the approach: the plan does not move the axis
  std::uint16_t longest_coast_periods = 0;  // lawful, of any kick
  bool metered = false;                     // the encoder is on the motor
  ShapedApproach<Scalar> approach{};
  KickTable<Scalar> table{};

  constexpr Scalar begin_m() const noexcept { return approach.begin_m; }
};

// Says whether the numbers can be those of an axis; written so that a NaN is refused.
template <class Scalar>
constexpr bool are_usable(const WorkKicks<Scalar>& k) noexcept {
  const ShapedApproach<Scalar>& a = k.approach;
  const bool forces = k.force_step_N > 0 && k.slow_lag >= 0 && k.slow_lag < 1 && k.breakaway_N > 0 &&
                      k.lost_motion_m >= 0 && k.spring_m >= 0 && k.creep_m >= 0 && k.friction_per_gain_N > 0 &&
                      k.speeding_s_per_kg > 0 && k.late_periods > 0;
  const bool waits = k.still_periods > 0 && k.patient_periods > 0 && k.longest_coast_periods > 0;
  const bool approach = a.mass_kg > 0 && a.friction_N >= 0 && a.acceleration_m_s2 > 0 && a.stiffness_N_per_m >= 0 &&
                        a.damping_Ns_per_m >= 0 && a.short_of_target_m >= 0 && a.begin_m > 0 && a.swing_periods > 0 &&
                        a.speed_periods > 0;
  return forces && waits && approach && k.table.is_usable() && !k.table.list;
}

}  // namespace breakaway::law
