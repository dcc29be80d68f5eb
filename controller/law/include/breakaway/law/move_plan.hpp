// MovePlan: the acceleration of the next period of a move whose jerk is limited, from wherever the axis is and however
// it moves.
//
// A move ends where brake and least friction take over, at the speed w1 and with their deceleration g, and not at rest.
// Less a constant speed W, that is on the way of a stop to rest: the one that passes g at w1 - W = g^2 / (2 j), g / j
// before its end. From the speed w and the acceleration a, both towards the target, and less W, that stop takes T and
// S:
//   from a = 0:   T0(w) = 2 sqrt(w / j) while the deceleration d is not reached, w <= d^2 / j, or else w / d + d / j;
//                 S0(w) = w T0 / 2
//   from a < 0:   the axis is on such a stop already, which began at w + a^2 / (2 j), |a| / j ago
//   otherwise:    a is brought to 0 first, which takes t = |a| / j and w t + a t^2 / 3
// and the way to where the move ends is S + W T, less the same from there on.
// A period changes the acceleration by j T at most, up as far as the stop still fits the way that is left after it, and
// the speed its limit. What is not known of friction makes a real axis stop sooner, and the next period counts from
// where it is: so nothing has to be followed, and a target that moves on the way is no case of its own.
#pragma once

#include <algorithm>
#include <cmath>

namespace breakaway::law {

// What an approach may plan, where a move has limits; 0: it has none. Accelerations are those of the axis as told under
// its least friction, so that no axis of the class exceeds what was asked for.
template <class Scalar>
struct MoveLimits {
  Scalar speed_m_s{};
  Scalar acceleration_m_s2{};
  Scalar deceleration_m_s2{};  // in braking; more than the curve that the axis comes down by needs
  Scalar jerk_m_s3{};          // 0: none

  // away: the axis may move the other way, where to speed up is to brake.
  constexpr Scalar within(Scalar acceleration, bool away) const noexcept {
    return std::clamp(acceleration, -deceleration_m_s2, away ? deceleration_m_s2 : acceleration_m_s2);
  }
  // How long a move from rest to rest takes that goes this fast on its way, or as fast as its way lets it. Requires
  // are_asked_for().
  [[gnu::cold]] Scalar time_s(Scalar distance_m, Scalar fastest_m_s) const noexcept {
    const Scalar v = highest_m_s(distance_m, fastest_m_s);
    return v > 0 ? distance_m / v + ramps_s(v) : Scalar{0};
  }
  // The speed with which it takes this long, or the limit where it cannot. d / v + r(v) is convex and falls up to the
  // highest speed that there is, so that Newton's steps from d / t, which is too slow, come to it from below.
  [[gnu::cold]] Scalar speed_for_m_s(Scalar distance_m, Scalar time_s) const noexcept {
    Scalar v = distance_m / time_s;
    for (int step = 0; step < most_steps && v > 0 && v < speed_m_s; ++step) {
      const Scalar way_s = distance_m / v, falling_s = way_s - growing_s(v);
      if (!(falling_s > 0)) return speed_m_s;
      v += v * ((way_s + ramps_s(v) - time_s) / falling_s);
    }
    return v > 0 && v < speed_m_s ? v : speed_m_s;
  }

  constexpr bool are_asked_for() const noexcept { return acceleration_m_s2 > 0; }
  // Written so that a NaN is refused.
  constexpr bool are_usable() const noexcept {
    return acceleration_m_s2 >= 0 && jerk_m_s3 >= 0 && (deceleration_m_s2 > 0) == are_asked_for() &&
           (speed_m_s > 0) == are_asked_for();
  }

 private:
  static constexpr int most_steps = 16;  // each of which takes three quarters of what a time is off, or more

  // Where the ramps take up all of the way, v r(v) = d, or the fastest. r grows between the root of v and v itself, so
  // that the geometric mean of v and d / r(v) is off by a quarter of what v is at most.
  [[gnu::cold, gnu::noinline]] Scalar highest_m_s(Scalar distance_m, Scalar fastest_m_s) const noexcept {
    if (!(distance_m > 0)) return 0;
    Scalar v = fastest_m_s;
    for (int step = 0; step < most_steps; ++step) v = std::min(fastest_m_s, std::sqrt(v * (distance_m / ramps_s(v))));
    return v;
  }
  // Half of the time that it takes to speed up to v and to brake again.
  [[gnu::cold, gnu::noinline]] Scalar ramps_s(Scalar v) const noexcept {
    return (ramp_s(v, acceleration_m_s2) + ramp_s(v, deceleration_m_s2)) / 2;
  }
  // v times its slope.
  [[gnu::cold, gnu::noinline]] Scalar growing_s(Scalar v) const noexcept {
    return (ramp_growing_s(v, acceleration_m_s2) + ramp_growing_s(v, deceleration_m_s2)) / 2;
  }
  Scalar rise_s(Scalar acceleration) const noexcept { return jerk_m_s3 > 0 ? acceleration / jerk_m_s3 : Scalar{0}; }
  // A ramp that does not reach its acceleration takes 2 sqrt(v / j), and one that does v / a + a / j.
  [[gnu::cold, gnu::noinline]] Scalar ramp_growing_s(Scalar v, Scalar acceleration) const noexcept {
    return v < acceleration * rise_s(acceleration) ? std::sqrt(v / jerk_m_s3) : v / acceleration;
  }
  Scalar ramp_s(Scalar v, Scalar acceleration) const noexcept {
    const Scalar growing = ramp_growing_s(v, acceleration);
    return growing + std::min(growing, rise_s(acceleration));
  }
};

// Where brake and least friction take over.
template <class Scalar>
struct MoveEnd {
  Scalar distance_m{};
  Scalar speed_m_s{};
  Scalar deceleration_m_s2{};
};

template <class Scalar>
class MovePlan {
 public:
  constexpr MovePlan() noexcept = default;
  // curve_m_s2: the deceleration that stops are planned with, at most limits.deceleration_m_s2.
  MovePlan(const MoveLimits<Scalar>& limits, const MoveEnd<Scalar>& end, Scalar curve_m_s2, Scalar period_s) noexcept
      : limits_{limits}, curve_{curve_m_s2}, period_s_{period_s} {
    if (!(limits.jerk_m_s3 > 0)) return;
    per_jerk_ = 1 / limits.jerk_m_s3;
    step_ = limits.jerk_m_s3 * period_s;
    // A jerk too small to have that deceleration at that speed ends the stop with less of it.
    const Scalar last_s = std::min(end.deceleration_m_s2 * per_jerk_, std::sqrt(2 * end.speed_m_s * per_jerk_));
    const Scalar last_m_s = limits.jerk_m_s3 * last_s * last_s / 2;
    more_m_s_ = std::max(end.speed_m_s - last_m_s, Scalar{0});
    end_m_ = end.distance_m - last_s * (last_m_s / 3 + more_m_s_);
  }

  constexpr void restart() noexcept { planned_ = 0; }
  constexpr void limit_speed(Scalar speed_m_s) noexcept { limits_.speed_m_s = speed_m_s; }
  constexpr void turn() noexcept { planned_ = -planned_; }
  constexpr bool limits_jerk() const noexcept { return per_jerk_ > 0; }
  // Only of a move whose jerk is limited.
  constexpr bool brakes_less_than(Scalar deceleration) const noexcept {
    return limits_jerk() && planned_ > -deceleration;
  }

  // The acceleration of a period that begins at this distance from the target, with this speed towards it.
  Scalar next(Scalar distance_m, Scalar speed_m_s, bool away) noexcept {
    const Room kept = room(distance_m, speed_m_s, planned_), raised = room(distance_m, speed_m_s, planned_ + step_);
    const Scalar share =
        std::min(share_of_step(kept.way_m, raised.way_m), share_of_step(kept.speed_m_s, raised.speed_m_s));
    planned_ = limits_.within(planned_ + share * step_, away);
    return planned_;
  }

  // The least distance from the target at which the move must be at this speed; negative where it moves away fast.
  Scalar stop_m(Scalar speed_m_s, Scalar acceleration) const noexcept {
    const Scalar w = speed_m_s - more_m_s_, t = std::abs(acceleration) * per_jerk_, gain_m_s = acceleration * t / 2;
    // A stop that is under way began |a| / j ago, and faster.
    const bool braking = acceleration * (w + gain_m_s) < 0;
    const Scalar back_s = braking ? -t : t, with_m_s = braking ? -gain_m_s : gain_m_s;
    // One that is slower than the end asks for has no need to stop.
    const Scalar from = std::max(w + with_m_s, Scalar{0});
    const Scalar stop_s = time_from_no_acceleration_s(from);
    return end_m_ + back_s * (w + acceleration * back_s / 3) + from * stop_s / 2 + more_m_s_ * (stop_s + back_s);
  }

 private:
  // What is left of the way and of the speed limit after a period.
  struct Room {
    Scalar way_m, speed_m_s;
  };

  Room room(Scalar distance_m, Scalar speed_m_s, Scalar acceleration) const noexcept {
    const Scalar after_m_s = speed_m_s + acceleration * period_s_;
    const Scalar highest_m_s = after_m_s + acceleration * (std::abs(acceleration) * per_jerk_) / 2;
    const Scalar left_m = distance_m - (speed_m_s + after_m_s) / 2 * period_s_;
    return {left_m - stop_m(after_m_s, acceleration), limits_.speed_m_s - highest_m_s};
  }

  // By which share of a step the acceleration may rise until nothing is left, by the secant; within one step.
  static Scalar share_of_step(Scalar kept, Scalar raised) noexcept {
    if (raised >= 0) return 1;
    return kept > raised ? std::max(kept / (kept - raised), Scalar{-1}) : Scalar{-1};
  }

  Scalar time_from_no_acceleration_s(Scalar w) const noexcept {
    return w <= curve_ * curve_ * per_jerk_ ? 2 * std::sqrt(w * per_jerk_) : w / curve_ + curve_ * per_jerk_;
  }

  MoveLimits<Scalar> limits_{};
  Scalar curve_ = 1;
  Scalar period_s_{};
  Scalar per_jerk_{};  // 0: no limit
  Scalar step_{};      // of the acceleration in a period
  Scalar more_m_s_{};  // W
  Scalar end_m_{};     // of the stop to rest, seen from the target
  Scalar planned_{};   // acceleration of the last period
};

}  // namespace breakaway::law
