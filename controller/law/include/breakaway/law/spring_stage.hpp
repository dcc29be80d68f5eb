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
// the force is kept. Where it is at its limit and the axis rests outside the tolerance, a kick starts from there.
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
  constexpr SpringStage(const FrictionSpring<Scalar>& spring, Scalar resolution_m) noexcept
      : spring_{spring}, near_m_{resolution_m * Scalar(0.55)} {}

  // Whether an axis at rest there is the stage's.
  constexpr bool reaches(Scalar x) const noexcept { return std::abs(x) <= spring_.reach_m; }
  constexpr bool active() const noexcept { return active_; }

  constexpr void start(Scalar x) noexcept {
    active_ = true;
    middle_m_ = x;
    force_N_ = 0;
    waited_ = 0;
    waits_ = false;
  }
  constexpr void stop() noexcept { active_ = false; }
  // It has all its time again, to lead an axis back that was pushed.
  constexpr void begin_anew() noexcept { waited_ = 0; }

  // Takes the newest reading, once a period while the stage is active. Returns true in the period from which on the
  // force waits for the axis to rest.
  constexpr bool see(Scalar x) noexcept {
    middle_m_ += spring_.share * (x - middle_m_);
    const bool kept = std::abs(middle_m_) <= near_m_;
    const Scalar wanted_N = force_N_ - spring_.gain_N_per_m * middle_m_;
    if (!kept) force_N_ = std::clamp(wanted_N, -spring_.most_N, spring_.most_N);
    if (waited_ < spring_.longest_periods) ++waited_;
    const bool waited = waits_;
    waits_ = kept || std::abs(wanted_N) >= spring_.most_N;
    return waits_ && !waited;
  }

  // The force stays as it is, at the target or at its limit.
  constexpr bool waits() const noexcept { return waits_; }
  // The stage has taken longer than it may.
  constexpr bool overdue() const noexcept { return waited_ >= spring_.longest_periods; }
  constexpr Scalar force_N() const noexcept { return force_N_; }

 private:
  FrictionSpring<Scalar> spring_{};
  Scalar near_m_{};
  Scalar force_N_{};
  Scalar middle_m_{};         // of the readings
  std::uint16_t waited_ = 0;  // periods
  bool active_ = false;
  bool waits_ = false;
};

}  // namespace breakaway::law
