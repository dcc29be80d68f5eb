// SpringStage: the last micrometres on the spring that friction is before it slides.
//
// Friction that bends before it slides (pre-sliding: Dahl 1968, LuGre 1995) holds an axis at rest as a spring of the
// stiffness s0 does, so that a constant force h moves it, and lets it stay there. Each period
//
//   h <- h - K x,   |h| <= h_most < f_lo
//
// leads it to the target, as far as h_most reaches, which is about f_lo/s0. A force below the least friction cannot
// keep the axis sliding, so it does not hunt; an axis that holds at once just stays where it is. x is the mean of the
// readings over some of the ringing on the spring, which a force that follows it late would pump. While |x| <= 0.55 q
// the force is kept, and after its longest time. Where it is at its limit and the axis rests outside the tolerance, a
// kick starts from there.
//
// A step of the force sets the axis ringing by as much as it moves it, and the next may add to that. Where that is more
// than a quarter of a count, the force is kept wherever the axis is near enough, and in a hold.
//
// An axis that rests near enough, but further away than such a force leads, is only watched: it may ring still.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "breakaway/law/braked_kicks.hpp"

namespace breakaway::law {

template <class Scalar>
class SpringStage {
 public:
  constexpr SpringStage() noexcept = default;
  constexpr SpringStage(const FrictionSpring<Scalar>& spring, Scalar resolution_m, Scalar tolerance_m) noexcept
      : spring_{spring}, near_m_{Scalar(0.55) * resolution_m}, is_smooth_{spring.step_m <= resolution_m / 4} {
    if (!is_smooth_) near_m_ = std::max(near_m_, tolerance_m);
  }

  constexpr bool is_there() const noexcept { return spring_.is_there(); }
  // Whether an axis at rest there is led.
  constexpr bool reaches(Scalar x) const noexcept { return std::abs(x) <= spring_.reach_m; }
  constexpr bool active() const noexcept { return active_; }

  constexpr void start(Scalar x) noexcept {
    active_ = true;
    middle_m_ = x;
    force_N_ = 0;
    most_N_ = reaches(x) ? spring_.most_N : Scalar{0};
    waited_ = 0;
    waits_ = false;
  }
  constexpr void stop() noexcept { active_ = false; }
  // It has all its time again, to lead an axis back that was pushed.
  constexpr void begin_anew() noexcept { waited_ = 0; }

  // Takes the newest reading, once a period while the stage is active. Returns true in the period from which on the
  // force waits for the axis to rest.
  constexpr bool see(Scalar x) noexcept {
    const bool waited = waits_, is_late = waited_ >= spring_.longest_periods;
    if (!overdue()) ++waited_;
    lead(x, is_late);
    return waits_ && !waited;
  }
  // The same of an axis that is held.
  constexpr void watch(Scalar x) noexcept {
    if (is_smooth_) lead(x, false);
  }

  // By the mean of its readings the axis is where the force is kept.
  constexpr bool is_near() const noexcept { return std::abs(middle_m_) <= near_m_; }
  // The force stays as it is, at the target or at its limit.
  constexpr bool waits() const noexcept { return waits_; }
  // The stage has taken longer than it may, also to ring out.
  constexpr bool overdue() const noexcept { return waited_ >= spring_.longest_periods + spring_.ringing_periods; }
  constexpr Scalar force_N() const noexcept { return force_N_; }

 private:
  [[gnu::cold, gnu::noinline]] constexpr void lead(Scalar x, bool is_kept) noexcept {
    middle_m_ += spring_.share * (x - middle_m_);
    const Scalar wanted_N = force_N_ - spring_.gain_N_per_m * middle_m_;
    is_kept = is_kept || is_near();
    if (!is_kept) force_N_ = std::clamp(wanted_N, -most_N_, most_N_);
    waits_ = is_kept || std::abs(wanted_N) >= most_N_;
  }

  FrictionSpring<Scalar> spring_{};
  Scalar near_m_{};
  Scalar force_N_{};
  Scalar most_N_{};
  Scalar middle_m_{};         // of the readings
  std::uint16_t waited_ = 0;  // periods
  bool is_smooth_ = false;    // a step of the force moves the axis by a quarter of a count at most
  bool active_ = false;
  bool waits_ = false;
};

}  // namespace breakaway::law
