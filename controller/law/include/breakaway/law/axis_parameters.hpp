// AxisParameters: everything that the control law needs to know of one axis, in SI units.
//
// Conventions of this room: x = position - target, positive force pushes towards positive x, v = dx/dt. A rotary axis
// reads kg m^2, N m and rad for kg, N and m.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "breakaway/law/friction_bounds.hpp"

namespace breakaway::law {

// What follows a kick until the axis rests.
enum class Coast : std::uint8_t {
  pd,     // the feedback (16) of [I] with the damping k22
  brake,  // a constant force against the motion, weaker than the least friction
  work,   // no force; the pulse before it ends by the work that it has done, for a load on a spring
};

template <class Scalar>
struct AxisParameters {
  Scalar mass_kg{};
  Scalar stiffness_N_per_m{};                                               // k1 of (16), > 0
  Scalar approach_damping_Ns_per_m{};                                       // k21 of (16): zeta < 1
  Scalar kick_damping_Ns_per_m{};                                           // k22 of (16): zeta > 1
  FrictionBounds<Scalar> friction{};                                        // of the dry friction force, Assumption 1
  Scalar max_force_N = std::numeric_limits<Scalar>::infinity();             // of the sum of feedback and kick
  Scalar max_approach_speed_m_s = std::numeric_limits<Scalar>::infinity();  // infinity: (16) as printed
  Scalar position_tolerance_m{};     // at rest within this the axis is left alone; 0: kicked for ever smaller errors
  Scalar encoder_resolution_m{};     // one count; 0: exact position and velocity are measured
  Scalar period_s{};                 // control period; 0: the ideal law, a kick is an impulse
  std::uint8_t latency_periods = 1;  // from taking a sample to the first force computed from it
  Coast coast = Coast::pd;
  Scalar flicker_m{};      // what readings of an axis at rest may differ by; under any coast but pd
  Scalar feedforward_N{};  // given beside max_force_N while there is no fault, against a known constant force

  constexpr bool exact() const noexcept { return !(encoder_resolution_m > 0); }
  constexpr bool ideal() const noexcept { return !(period_s > 0); }

  // Of all that the drive is asked for.
  constexpr Scalar total_force_N() const noexcept {
    return max_force_N + (feedforward_N < 0 ? -feedforward_N : feedforward_N);
  }

  // An axis whose reading differs from an earlier one by less than half of this may have rested since: readings at rest
  // differ by whole counts, up to the flicker. One that moved by all of it is read to have moved by a count more.
  constexpr Scalar unseen_m() const noexcept { return encoder_resolution_m + 2 * flicker_m; }

  constexpr Scalar stick_radius_upper_m() const noexcept {
    return friction.upper_N / stiffness_N_per_m;
  }  // c_hi of (9)

  // The least distance that a pulse of one period moves the axis from rest, if friction is f_hi until it breaks away
  // and f_lo from then on: a kick that is sure to move the axis cannot aim for less.
  constexpr Scalar accuracy_floor_m() const noexcept {
    return period_s * period_s * friction.upper_N * (friction.upper_N - friction.lower_N) /
           (2 * mass_kg * friction.lower_N);
  }
};

enum class ParameterError : std::uint8_t {
  none,
  mass_not_positive,
  stiffness_not_positive,
  approach_not_underdamped,
  kick_not_overdamped,
  friction_lower_not_positive,
  friction_bounds_reversed,
  max_force_below_friction,
  feedforward_not_finite,
  max_approach_speed_not_positive,
  tolerance_negative,
  encoder_resolution_negative,
  flicker_negative,
  period_negative,
  brake_without_period,
};

constexpr std::string_view to_string(ParameterError error) noexcept {
  switch (error) {
    case ParameterError::none:
      return "parameters are valid";
    case ParameterError::mass_not_positive:
      return "mass must be positive and finite";
    case ParameterError::stiffness_not_positive:
      return "stiffness k1 must be positive and finite";
    case ParameterError::approach_not_underdamped:
      return "approach damping k21 must satisfy 0 < k21 < 2 sqrt(k1 m)";
    case ParameterError::kick_not_overdamped:
      return "kick damping k22 must exceed 2 sqrt(k1 m)";
    case ParameterError::friction_lower_not_positive:
      return "lower friction bound must be positive and finite";
    case ParameterError::friction_bounds_reversed:
      return "upper friction bound must be finite and not below the lower one";
    case ParameterError::max_force_below_friction:
      return "force limit must exceed the upper friction bound, or no kick is sure to move the axis";
    case ParameterError::feedforward_not_finite:
      return "feedforward must be a number";
    case ParameterError::max_approach_speed_not_positive:
      return "approach speed limit must be positive";
    case ParameterError::tolerance_negative:
      return "position tolerance must not be negative";
    case ParameterError::encoder_resolution_negative:
      return "encoder resolution must not be negative";
    case ParameterError::flicker_negative:
      return "flicker of the encoder must not be negative";
    case ParameterError::period_negative:
      return "control period must not be negative";
    case ParameterError::brake_without_period:
      return "coasts \"brake\" and \"work\" need a control period and an encoder resolution above 0";
  }
  return "unknown parameter error";
}

// The first rule that the parameters break. Written so that a NaN breaks the rule that it stands in.
template <class Scalar>
[[gnu::cold]] constexpr ParameterError validate(const AxisParameters<Scalar>& p) noexcept {
  constexpr Scalar infinity = std::numeric_limits<Scalar>::infinity();
  const auto positive = [](Scalar value) { return value > 0 && value < infinity; };
  const auto not_negative = [](Scalar value) { return value >= 0 && value < infinity; };
  if (!positive(p.mass_kg)) return ParameterError::mass_not_positive;
  if (!positive(p.stiffness_N_per_m)) return ParameterError::stiffness_not_positive;
  // zeta^2 = k^2 / (4 k1 m) against 1: a square root is no constant expression.
  const auto squared_ratio = [&p](Scalar damping) {
    return damping / (4 * p.mass_kg) * (damping / p.stiffness_N_per_m);
  };
  const Scalar k21 = p.approach_damping_Ns_per_m, k22 = p.kick_damping_Ns_per_m;
  if (!(k21 > 0 && squared_ratio(k21) < 1)) return ParameterError::approach_not_underdamped;
  if (!(squared_ratio(k22) > 1 && k22 > 0 && k22 < infinity)) return ParameterError::kick_not_overdamped;
  if (!positive(p.friction.lower_N)) return ParameterError::friction_lower_not_positive;
  if (!(p.friction.upper_N >= p.friction.lower_N && p.friction.upper_N < infinity))
    return ParameterError::friction_bounds_reversed;
  if (!(p.max_force_N > p.friction.upper_N)) return ParameterError::max_force_below_friction;
  if (!not_negative(p.feedforward_N < 0 ? -p.feedforward_N : p.feedforward_N))
    return ParameterError::feedforward_not_finite;
  if (!(p.max_approach_speed_m_s > 0)) return ParameterError::max_approach_speed_not_positive;
  if (!not_negative(p.position_tolerance_m)) return ParameterError::tolerance_negative;
  if (!not_negative(p.encoder_resolution_m)) return ParameterError::encoder_resolution_negative;
  if (!not_negative(p.flicker_m)) return ParameterError::flicker_negative;
  if (!not_negative(p.period_s)) return ParameterError::period_negative;
  if (p.coast != Coast::pd && !(p.period_s > 0 && p.encoder_resolution_m > 0))
    return ParameterError::brake_without_period;
  return ParameterError::none;
}

}  // namespace breakaway::law
