// Every controller of this room takes a Measurement once a period, and gives a ControlOutput.
#pragma once

#include <cmath>
#include <cstdint>
#include <string_view>

namespace breakaway::law {

template <class Scalar>
struct Measurement {
  Scalar position_error_m{};  // x = position - target
  Scalar velocity_m_s{};      // read only when the encoder resolution is 0; otherwise estimated from positions
  bool fresh = true;          // false: no new sample came this period (a lost frame); the fields above are not read
};

// Whether a period has a new position.
enum class Reading : std::uint8_t { there, lost };

// The modes of AxisController, defined by the inequalities that lead into them.
enum class Mode : std::uint8_t {
  approach,  // since the last target change, never certified at rest: damping k21
  kick,      // a pulse is under way
  coast,     // after a pulse, not yet certified at rest: damping k22
  hold,      // certified at rest with |x| <= position_tolerance_m, or under the brake where kicks are sure to have led
             // there
  fault,     // latched until reset(): no force
};

enum class ControlFault : std::uint8_t {
  none,
  not_a_number,  // a measurement was NaN or infinite
  jammed,        // many kicks in a row, each stronger than the last, did not move the axis
  diverging,     // the error grew after many kicks in a row: friction, mass or force gain is outside its stated bounds
  hunting,       // many kicks moved the axis and did not bring it to its target: the same causes
  drifting,      // the axis does not stop without force: a force beside the drive's exceeds its friction
  contradicted,  // kicks showed friction outside the stated bounds; seen_friction_N() of the law says how much
  spring_limit,  // coast "work": at rest nearer to the target than what the spring may add to a kick
  below_floor,   // coast "work": at rest where no pulse is sure to move the load and not to go beyond the target
};

template <class Scalar>
struct ControlOutput {
  Scalar force_N{};     // for the next period; |force_N| <= max_force_N for any input bits
  Scalar impulse_Ns{};  // at once; only of the ideal law (period 0), where a kick takes no time
  Mode mode = Mode::approach;
  bool kicked = false;  // a kick starts with this output
};

constexpr std::string_view to_string(Mode mode) noexcept {
  switch (mode) {
    case Mode::approach:
      return "approach";
    case Mode::kick:
      return "kick";
    case Mode::coast:
      return "coast";
    case Mode::hold:
      return "hold";
    case Mode::fault:
      return "fault";
  }
  return "unknown mode";
}

constexpr std::string_view to_string(ControlFault fault) noexcept {
  switch (fault) {
    case ControlFault::none:
      return "none";
    case ControlFault::not_a_number:
      return "measurement is not a number";
    case ControlFault::jammed:
      return "axis does not move under kicks";
    case ControlFault::diverging:
      return "position error grows under kicks";
    case ControlFault::hunting:
      return "kicks do not bring the axis to its target";
    case ControlFault::drifting:
      return "axis does not stop without force";
    case ControlFault::spring_limit:
      return "axis rests nearer than its spring lets a kick aim";
    case ControlFault::below_floor:
      return "axis rests nearer than a kick is sure to move its load by";
    case ControlFault::contradicted:
      return "kicks show friction outside its stated bounds";
  }
  return "unknown control fault";
}

// Returns the force within +-limit. NaN becomes zero, because a force that nobody computed must not act.
template <class Scalar>
constexpr Scalar limited(Scalar force_N, Scalar limit_N) noexcept {
  if (std::abs(force_N) <= limit_N) return force_N;
  if (force_N > 0) return limit_N;
  return force_N < 0 ? -limit_N : Scalar{0};
}

}  // namespace breakaway::law
