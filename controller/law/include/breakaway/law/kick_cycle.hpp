// KickCycle: one kick of the coast "brake", from rest to rest.
//
// Let the kick be towards +x, A the least and B the greatest friction, b < A the brake, F the force of the pulse.
//   preload   u -> b       so that the pulse starts from a known force; the axis stays at rest, because b < A. A drive
//                          that does not get there, because its limit was lowered, gives its pulse all the same
//   pulse     u -> F       for n whole periods
//   cut       u -> -c      for so many periods that the fastest current loop has come down to -b at their end
//   brake     u -> -b      until rest is certified
// It never goes further than under constant friction A: while v > 0, m dv/dt = u - f <= u - A for every friction
// f(t, x, v) >= A, so the travel is at most the one that the table was made for. After the stop |u| <= b < A, so that
// the axis stays. Nothing in this looks at a measurement, so latency plays no part in it.
//
// Rest is certified as in RestDetector: an axis that still moved forward under u <= theta < A would lose speed at
// (A - theta)/m at least, and so would have travelled a count within W = sqrt(2 q m / (A - theta)). Readings count once
// they show the time after the force came down to theta.
//
// Three guards act where the axis is not what was stated. Where the brake itself drives the axis back, or a coast
// outlasts the longest lawful one, the brake is taken off; from then on the axis may move either way, and rest takes
// the longer proof for that. An axis seen still for `patient_periods` under whatever force counts as resting, because
// nothing more can be learnt by waiting.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "breakaway/law/braked_kicks.hpp"
#include "breakaway/law/force_interval.hpp"
#include "breakaway/law/force_steps.hpp"

namespace breakaway::law {

template <class Scalar>
class KickCycle {
 public:
  enum class Phase : std::uint8_t {
    free,      // the force comes from elsewhere
    preload,   // at rest, until the force is known to be near the brake's
    pulse,     // periods of constant force
    cut,       // the force is brought down as fast as the drive can
    brake,     // constant force against the motion, not yet certified at rest
    released,  // no force, not yet certified at rest
  };

  KickCycle() noexcept = default;
  // unseen_m: AxisParameters::unseen_m(), without noise a count.
  KickCycle(const BrakedKicks<Scalar>& kicks, Scalar unseen_m, Scalar max_force_N, std::uint8_t latency) noexcept
      : kicks_{&kicks},
        half_count_m_{unseen_m / 2},
        ringing_m_{half_count_m_ * (kicks.spring.is_there() ? Scalar{3} : Scalar{1})},
        still_m_{ringing_m_},
        reverse_limit_m_{unseen_m * Scalar(2.5)},
        brake_steps_{whole_steps(kicks.brake_N + kicks.force_step_N / 2)},
        latency_{latency},
        lags_{kicks.slow_lag > 0} {
    limit_force(max_force_N);
    reduced_ = false;
  }

  void limit_force(Scalar force_N) noexcept {
    reduced_ = true;
    most_steps_ = force_limit_steps(force_N, kicks_->force_step_N);
    brake_steps_ = std::min(brake_steps_, most_steps_);
  }

  // Lets the force come from elsewhere, at rest. From now on an axis that shows another count is not still.
  void set_free() noexcept {
    set_phase_free();
    still_m_ = half_count_m_;
  }

  // Forgets what was seen; the force may be anything that was commanded before.
  void restart() noexcept {
    set_phase_free();
    still_m_ = ringing_m_;
    still_ = 0;
    anchored_ = false;
  }

  // The target moved on by this much, and what is under way goes on.
  void shift_origin(Scalar shift_m) noexcept {
    anchor_m_ -= shift_m;
    furthest_m_ -= shift_m * direction_;
  }

  // The drive makes no force.
  void forget_force() noexcept { interval_ = {}; }

  // Takes the newest position. To be called once a period before next_steps(), where there is a reading.
  void see(Scalar position_m) noexcept {
    const Scalar moved_m = position_m - anchor_m_;
    // Millions of counts away a number of this type no longer holds each of them.
    const Scalar unseen_m = still_m_ + std::abs(position_m) * std::numeric_limits<Scalar>::epsilon();
    if (!anchored_ || std::abs(moved_m) > unseen_m) {
      anchor_m_ = position_m;
      anchored_ = true;
      still_ = 0;
    } else if (still_ < longest) {
      ++still_;
    }
    if (phase_ == Phase::pulse || phase_ == Phase::cut || phase_ == Phase::brake) watch_direction(position_m);
  }

  // Starts a kick along `direction`, +1 or -1.
  void kick(Scalar direction, const Pulse<Scalar>& pulse) noexcept {
    direction_ = direction;
    const std::int32_t wanted_steps = whole_steps(pulse.force_N);
    pulse_steps_ = std::clamp(wanted_steps, std::int32_t{0}, most_steps_);
    pulse_limited_ = reduced_ && wanted_steps > most_steps_;
    pulse_periods_ = std::max(pulse.periods, std::uint8_t{1});
    cut_periods_ = kicks_->fast_lag > 0 ? pulse.cut_periods : std::uint8_t{0};
    either_way_ = driven_back_ = false;
    overdue_in_ = longest;  // until it brakes
    if (lags_)
      enter(Phase::preload, kicks_->patient_periods + kicks_->settling_periods);
    else
      enter(Phase::pulse, pulse_periods_);
  }

  // Brakes an axis that moves along `direction`; longest_periods: the longest lawful coast.
  void brake(Scalar direction, Scalar longest_periods) noexcept {
    direction_ = direction;
    either_way_ = true;
    furthest_m_ = anchor_m_ * direction;
    enter_brake(within_range(longest_periods));
  }

  // Takes every force off an axis that has stopped after these periods at the latest.
  void release(Scalar longest_periods) noexcept {
    expect_rest_within(within_range(longest_periods));
    take_brake_off();
  }

  // Returns the force of the next period in whole steps; `free_steps` in the phase free.
  std::int32_t next_steps(std::int32_t free_steps) noexcept {
    if (phase_ == Phase::free) return next_free_steps(free_steps);
    return brakes() ? next_resting_steps() : next_kicking_steps();
  }
  // The same where that is sure to be free; or for an axis that is held without a force, of which nothing is counted.
  std::int32_t next_free_steps(std::int32_t steps) noexcept {
    const std::int32_t given = within_limit(steps);
    follow(given);
    return given;
  }

  // A force that was commanded without it.
  void follow(std::int32_t steps) noexcept {
    interval_.follow(static_cast<Scalar>(steps) * kicks_->force_step_N, kicks_->fast_lag, kicks_->slow_lag);
  }

  // Of the last kick.
  Scalar pulse_N() const noexcept { return static_cast<Scalar>(pulse_steps_) * kicks_->force_step_N; }
  std::uint8_t pulse_periods() const noexcept { return pulse_periods_; }
  // It was weaker than what the table was made for.
  bool pulse_limited() const noexcept { return pulse_limited_; }
  Scalar direction() const noexcept { return direction_; }
  // The brake moved the axis, so that friction is weaker.
  bool driven_back() const noexcept { return driven_back_; }

  // The axis ought to rest since long.
  bool overdue() const noexcept { return overdue_in_ == 0; }

  // Rest is certified, or there is no more to wait for.
  bool at_rest() const noexcept {
    if (!brakes()) return false;
    if (patient()) return true;
    const std::int32_t shown = std::min(still_, calm_ - latency_);
    return shown >= (either_way_ ? kicks_->either_way_periods : kicks_->still_periods);
  }
  bool patient() const noexcept { return still_ >= kicks_->patient_periods; }
  void forget_patience() noexcept { still_ = 0; }
  // An axis that rests under a force that was kept since forget_patience() shows no other reading for so long.
  bool stays() const noexcept { return still_ >= kicks_->either_way_periods + latency_; }
  // Nor does it ring any more, which readings twice a ring may hide, and which lets friction that bends creep.
  bool has_rung_out() const noexcept { return still_ >= kicks_->spring.ringing_periods / 2 + latency_; }

  Phase phase() const noexcept { return phase_; }
  const BrakedKicks<Scalar>& kicks() const noexcept { return *kicks_; }
  // Of the last call of next_steps(): whether a pulse began with it, and whether it was one of a pulse.
  bool pulse_starts() const noexcept { return pulse_starts_; }
  bool pulsed() const noexcept { return pulsed_; }
  const ForceInterval<Scalar>& interval() const noexcept { return interval_; }

  std::int32_t whole_steps(Scalar force_N) const noexcept { return whole_force_steps(force_N, kicks_->force_step_N); }
  std::int32_t within_limit(std::int32_t steps) const noexcept { return std::clamp(steps, -most_steps_, most_steps_); }

 private:
  static constexpr std::int32_t longest = 65535;  // count of periods

  static std::int32_t within_range(Scalar periods) noexcept {
    return periods < Scalar(longest) ? static_cast<std::int32_t>(periods) : longest;
  }

  // Nothing is counted until a kick, a brake or a release, each of which starts its counts itself.
  void set_phase_free() noexcept {
    phase_ = Phase::free;
    pulsed_ = pulse_starts_ = false;
  }
  // The axis slows down or rests: the last two phases.
  bool brakes() const noexcept { return phase_ >= Phase::brake; }

  void enter(Phase phase, std::int32_t periods) noexcept {
    phase_ = phase;
    left_ = periods;
    still_m_ = ringing_m_;
    if (phase == Phase::pulse) furthest_m_ = anchor_m_ * direction_;
    // A long pulse may move the axis by less than a count, and so may an approach: that it was not seen to move before
    // the brake began says nothing about rest.
    if (phase == Phase::pulse || phase == Phase::brake) still_ = calm_ = 0;
  }

  void enter_brake(std::int32_t longest_periods) noexcept {
    expect_rest_within(longest_periods);
    enter(Phase::brake, longest_periods);
    calm_N_ = {-kicks_->holding_force_N, either_way_ ? kicks_->holding_force_N : kicks_->resting_force_N};
    if (!either_way_) calm_N_ = calm_N_.along(direction_);
  }

  // The brake must not drive the axis back.
  void watch_direction(Scalar position_m) noexcept {
    const Scalar along_m = position_m * direction_;
    if (along_m > furthest_m_) furthest_m_ = along_m;
    if (phase_ == Phase::brake && along_m < furthest_m_ - reverse_limit_m_) {
      driven_back_ = true;
      take_brake_off();
    }
  }

  std::int32_t next_kicking_steps() noexcept {
    const std::int32_t steps = along(steps_of_kick());
    follow(steps);
    count_down();
    if (overdue_in_ > 0) --overdue_in_;
    return steps;
  }

  std::int32_t next_resting_steps() noexcept {
    pulsed_ = pulse_starts_ = false;
    const std::int32_t steps = phase_ == Phase::brake ? -along(brake_steps_) : 0;
    // Without a lag the force of the whole period is what is commanded, else its start is the worst of it.
    if (lags_) note_calm();
    follow(steps);
    if (!lags_) note_calm();
    if (phase_ == Phase::brake && (left_ == 0 || --left_ == 0)) take_brake_off();
    if (overdue_in_ > 0) --overdue_in_;
    return steps;
  }

  std::int32_t along(std::int32_t steps) const noexcept { return direction_ < 0 ? -steps : steps; }

  // Along its direction.
  std::int32_t steps_of_kick() noexcept {
    pulsed_ = pulse_starts_ = false;
    if (phase_ == Phase::cut) return -within_limit(cut_steps());
    if (phase_ == Phase::preload) {
      const ForceInterval<Scalar> u = interval_.along(direction_);
      if (!preloaded(u)) return within_limit(preload_steps(u));
      enter(Phase::pulse, pulse_periods_);
    }
    pulsed_ = true;
    pulse_starts_ = left_ == pulse_periods_;
    return pulse_steps_;
  }

  // A pulse that started from more force than the brake's would go further than the table says.
  bool preloaded(const ForceInterval<Scalar>& u) const noexcept {
    const Scalar most_N = kicks_->brake_N + (kicks_->holding_force_N - kicks_->brake_N) / 512;
    return u.lower_N >= kicks_->preload_N && u.upper_N <= most_N;
  }

  // So much that the fastest loop reaches the brake's force at the end of the period. From above it comes down by
  // itself. Rounding must not lose the brake's last step, which a pulse may need to start from.
  std::int32_t preload_steps(const ForceInterval<Scalar>& u) const noexcept {
    if (u.upper_N > kicks_->brake_N) return brake_steps_;
    const Scalar left = kicks_->fast_lag;
    return std::max(whole_steps((kicks_->brake_N - u.upper_N * left) / (1 - left)), brake_steps_);
  }

  // So much that the fastest loop has come down to the brake's force at the end of the longest cut, from the least
  // force that it may have at the end of the pulse.
  std::int32_t cut_steps() const noexcept {
    const Scalar after_pulse = power(kicks_->short_lag, pulse_periods_);
    const Scalar after_cut = power(kicks_->fast_lag, cut_periods_);
    const Scalar force_N = static_cast<Scalar>(pulse_steps_) * kicks_->force_step_N;
    const Scalar end_N = force_N + (kicks_->preload_N - force_N) * after_pulse;
    return whole_steps((kicks_->brake_N + end_N * after_cut) / (1 - after_cut));
  }

  static Scalar power(Scalar base, unsigned exponent) noexcept {
    Scalar result = 1;
    for (; exponent > 0; exponent /= 2) {
      if (exponent % 2 == 1) result *= base;
      base *= base;
    }
    return result;
  }

  // Counts the periods whose force proves rest.
  void note_calm() noexcept {
    const bool calm = interval_.upper_N <= calm_N_.upper_N && interval_.lower_N >= calm_N_.lower_N;
    calm_ = calm ? std::min(calm_ + 1, longest) : 0;
  }

  void count_down() noexcept {
    if (phase_ == Phase::preload && --left_ <= 0)
      enter(Phase::pulse, pulse_periods_);
    else if (phase_ == Phase::pulse && --left_ == 0)
      cut_periods_ > 0 ? enter(Phase::cut, cut_periods_) : enter_brake(longest_coast());
    else if (phase_ == Phase::cut && --left_ == 0)
      enter_brake(longest_coast());
  }

  void take_brake_off() noexcept {
    either_way_ = true;
    calm_ = 0;
    calm_N_ = {-kicks_->holding_force_N, kicks_->holding_force_N};
    enter(Phase::released, 0);
  }

  // With the proof of rest, and four times as long because mass and friction may be off by as much as that.
  void expect_rest_within(std::int32_t periods) noexcept {
    overdue_in_ = 4 * (periods + kicks_->patient_periods + kicks_->settling_periods) + kicks_->spring.ringing_periods;
  }

  std::int32_t longest_coast() const noexcept {
    const Scalar force_N = static_cast<Scalar>(pulse_steps_) * kicks_->force_step_N;
    const Scalar coast = force_N * kicks_->coast_per_N * static_cast<Scalar>(pulse_periods_);
    return within_range(coast + static_cast<Scalar>(kicks_->still_periods + kicks_->settling_periods + latency_ + 3));
  }

  const BrakedKicks<Scalar>* kicks_ = nullptr;
  ForceInterval<Scalar> interval_{};
  ForceInterval<Scalar> calm_N_{};  // within it the force proves rest
  Scalar half_count_m_{};
  Scalar ringing_m_{};  // by which the reading of an axis may change that rings on its friction
  Scalar still_m_{};    // by which the reading of an axis that counts as still may change
  Scalar reverse_limit_m_{};
  Scalar anchor_m_{};
  Scalar furthest_m_{};
  Scalar direction_ = 1;
  std::int32_t most_steps_ = 0;
  std::int32_t brake_steps_ = 0;
  std::int32_t pulse_steps_ = 0;
  std::int32_t calm_ = 0;
  std::int32_t still_ = 0;
  std::int32_t left_ = 0;
  std::int32_t overdue_in_ = 0;
  std::uint8_t pulse_periods_ = 1;
  std::uint8_t cut_periods_ = 0;
  std::uint8_t latency_ = 0;
  Phase phase_ = Phase::free;
  bool lags_ = false;     // the force behind the command
  bool reduced_ = false;  // the force limit is below the one that the table was made for
  bool pulse_limited_ = false;
  bool anchored_ = false;
  bool either_way_ = false;
  bool driven_back_ = false;
  bool pulsed_ = false;
  bool pulse_starts_ = false;
};

}  // namespace breakaway::law
