// What is sure of an axis that its law holds, for who watches that nothing else moves it.
#pragma once

#include <algorithm>
#include <limits>

#include "breakaway/law/axis_parameters.hpp"
#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::law {

// Where nothing is known, nothing can be watched.
template <class Scalar>
struct HeldAxis {
  Scalar force_N = 0;  // beside the feedforward, either way: under it the axis stays where it rests, but for what bends
  Scalar allowed_m = std::numeric_limits<Scalar>::infinity();  // by more, kicks may not lead it back
  bool is_rigid = true;                                        // else a force either way may throw it either way
};

// By readings that are off either way.
template <class Scalar>
constexpr Scalar seen_off_m(const AxisParameters<Scalar>& p) noexcept {
  return p.position_tolerance_m + 2 * p.unseen_m();
}

// kicks: null under the coast "pd", for which no design says how much of the least friction is sure: half of it is
// taken.
template <class Scalar>
HeldAxis<Scalar> held_axis(const AxisParameters<Scalar>& p, const BrakedKicks<Scalar>* kicks) noexcept {
  if (kicks == nullptr) return {p.friction.lower_N / 2, p.stick_radius_upper_m() + seen_off_m(p), true};
  return {std::max(kicks->holding_force_N, kicks->spring.most_N),
          kicks->led_back_m() + seen_off_m(p) + 2 * kicks->spring.reach_m, true};
}

// As by the spring, too, is an axis bent while it is held.
template <class Scalar>
HeldAxis<Scalar> held_axis(const AxisParameters<Scalar>& p, const WorkKicks<Scalar>* kicks) noexcept {
  const Scalar away_m = kicks == nullptr ? p.stick_radius_upper_m() : kicks->begin_m();
  const Scalar bent_m = kicks == nullptr ? Scalar{0} : 2 * (kicks->spring_m + kicks->creep_m);
  return {p.friction.lower_N / 2, away_m + seen_off_m(p) + bent_m, false};
}

}  // namespace breakaway::law
