// WorkCycle: one kick of the coast "work", from rest to rest.
//
//   pulse   u -> F   for whole periods of the resonance, or until the work meter ends it
//   coast   u -> 0   until rest is certified
// The meter looks at the motor's travel D1 as it is read, adds what the motor may travel until the pulse can end, and
// gives the next period only while F D1 stays within what friction is sure to take up to the target. The motor gains
// at most a = (F - h)/m1 of speed, where h is what the spring cannot have pushed it by; so from the mean speed w of the
// last period, with a count q, it goes at most (w + q/T + a T/2) t + a t^2/2 within t. Each reading that is
// lost in a pulse makes t a period longer.
//
// Rest: the mass that the encoder does not see may swing on while the other sticks, and break it away again. So no
// count may change for as long as that can last (WorkKicks::still_periods).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "breakaway/law/force_interval.hpp"
#include "breakaway/law/force_steps.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::law {

template <class Scalar>
class WorkCycle {
 public:
  WorkCycle() noexcept = default;
  WorkCycle(const WorkKicks<Scalar>& kicks, Scalar unseen_m, Scalar max_force_N, std::uint8_t latency) noexcept
      : kicks_{&kicks}, unseen_m_{unseen_m}, latency_{latency} {
    limit_force(max_force_N);
  }

  void limit_force(Scalar force_N) noexcept { most_steps_ = force_limit_steps(force_N, kicks_->force_step_N); }

  void restart() noexcept {
    phase_ = Phase::free;
    pulse_starts_ = pulsed_ = false;
    still_ = blind_ = 0;
    anchored_ = false;
    last_full_ = 0;
    swings_ = 0;
  }
  void forget_force() noexcept {}

  // Takes the newest position. To be called once a period before next_steps(), where there is a reading.
  void see(Scalar position_m) noexcept {
    before_m_ = newest_m_;
    newest_m_ = position_m;
    const Scalar moved_m = position_m - anchor_m_;
    // Millions of counts away a number of this type no longer holds each of them.
    const Scalar unseen_m = unseen_m_ / 2 + std::abs(position_m) * std::numeric_limits<Scalar>::epsilon();
    if (!anchored_ || blind_ > 0 || moved_m > unseen_m || moved_m < -unseen_m) {
      anchor_m_ = position_m;
      anchored_ = true;
      still_ = 0;
      if (blind_ > 0) --blind_;
    } else if (still_ < longest) {
      ++still_;
    }
  }

  // A period without a reading. Until the pulse ends the meter takes what it reads for that much older.
  void skip() noexcept {
    if (phase_ != Phase::pulse || !kicks_->metered) return;
    late_ += 1;
    set_meter();
  }

  // Starts a kick along `direction`, +1 or -1, from rest at the distance_m from the target.
  void kick(Scalar direction, Scalar distance_m, const Pulse<Scalar>& pulse) noexcept {
    direction_ = direction;
    distance_m_ = distance_m;
    pulse_steps_ = std::clamp(whole_steps(pulse.force_N), std::int32_t{0}, most_steps_);
    pulse_periods_ = left_ = std::max(pulse.periods, std::uint8_t{1});
    start_m_ = newest_m_ * direction;
    late_ = kicks_->late_periods;
    given_ = 0;
    phase_ = Phase::pulse;
    starts_ = true;
    expect_rest_within(pulse_periods_ + kicks_->longest_coast_periods);
  }
  void set_period(Scalar period_s) noexcept { period_s_ = period_s; }

  // Without a force, after these periods at the latest the axis has stopped.
  void release(Scalar longest_periods) noexcept {
    expect_rest_within(longest_periods < Scalar(longest) ? static_cast<std::int32_t>(longest_periods) : longest);
    coast();
  }
  // What a feedback leaves of speed beside the plan's goes as that of a kick does.
  void brake(Scalar /*direction*/, Scalar longest_periods) noexcept {
    release(longest_periods + static_cast<Scalar>(kicks_->longest_coast_periods));
  }

  // Returns the force of the next period in whole steps; `free_steps` in the phase free.
  std::int32_t next_steps(std::int32_t free_steps) noexcept {
    pulse_starts_ = pulsed_ = false;
    if (phase_ == Phase::free) return next_free_steps(free_steps);
    if (overdue_in_ > 0) --overdue_in_;
    if (phase_ == Phase::pulse && kicks_->metered) {
      if (given_ == 1) set_meter();
      if (spent()) coast();
    }
    if (phase_ != Phase::pulse) return 0;
    pulse_starts_ = std::exchange(starts_, false);
    pulsed_ = true;
    ++given_;
    if (--left_ == 0) coast();
    return direction_ < 0 ? -pulse_steps_ : pulse_steps_;
  }

  // The same where the phase is free, or in a hold, and none.
  std::int32_t next_free_steps(std::int32_t steps) noexcept {
    const std::int32_t given = within_limit(steps);
    if (given == steps) return given;
    const std::int8_t side = given < 0 ? -1 : 1;
    if (side + last_full_ == 0 && swings_ < most_swings) ++swings_;
    last_full_ = side;
    return given;
  }

  Scalar pulse_N() const noexcept { return static_cast<Scalar>(pulse_steps_) * kicks_->force_step_N; }
  bool overdue() const noexcept { return overdue_in_ == 0; }
  bool at_rest() const noexcept { return phase_ == Phase::coast && still_ >= kicks_->still_periods; }
  bool patient() const noexcept { return still_ >= kicks_->patient_periods; }
  void forget_patience() noexcept { still_ = 0; }
  bool pulse_starts() const noexcept { return pulse_starts_; }
  bool pulsed() const noexcept { return pulsed_; }
  // The approach asks for more than all force to and fro: joint, mass or friction are not what was told, and the
  // feedback drives what it is to damp.
  bool driven_to_and_fro() const noexcept { return swings_ >= most_swings; }
  const ForceInterval<Scalar>& interval() const noexcept { return no_interval_; }

  std::int32_t whole_steps(Scalar force_N) const noexcept { return whole_force_steps(force_N, kicks_->force_step_N); }
  std::int32_t within_limit(std::int32_t steps) const noexcept { return std::clamp(steps, -most_steps_, most_steps_); }

 private:
  enum class Phase : std::uint8_t { free, pulse, coast };
  static constexpr std::int32_t longest = 65535;  // count of periods
  static constexpr std::uint8_t most_swings = 16;

  void coast() noexcept {
    phase_ = Phase::coast;
    still_ = 0;
    blind_ = latency_ + 2;
  }

  // In the period after the first of the pulse, which has work enough with the choice of it.
  void set_meter() noexcept {
    const WorkKicks<Scalar>& k = *kicks_;
    const Scalar force_N = pulse_N(), late = late_;
    const Scalar gained_m_s = std::max(force_N - k.held_back_N, Scalar{0}) * k.speeding_s_per_kg;  // in a period
    const Scalar most_m = k.friction_per_gain_N * (distance_m_ - k.spring_m) / force_N;
    // Of w t + travel, where w t is the last period's travel times `late`, the rest is known beforehand.
    most_travel_m_ = most_m - unseen_m_ * (1 + late) - gained_m_s * period_s_ * (late + late * late) / 2;
  }

  // Another period might take more work than friction is sure to have.
  bool spent() const noexcept {
    if (given_ <= latency_) return false;
    const Scalar travel_m = newest_m_ * direction_ - start_m_;
    return travel_m + (newest_m_ - before_m_) * direction_ * late_ > most_travel_m_;
  }

  // With the proof of rest, and four times as long because mass and friction may be off by as much as that.
  void expect_rest_within(std::int32_t periods) noexcept {
    overdue_in_ = 4 * (periods + kicks_->still_periods + blind_);
  }

  const WorkKicks<Scalar>* kicks_ = nullptr;
  ForceInterval<Scalar> no_interval_{};
  Scalar period_s_{};
  Scalar unseen_m_{};
  Scalar newest_m_{}, before_m_{}, anchor_m_{};
  Scalar start_m_{};        // along the kick
  Scalar distance_m_{};     // to the target, at the start
  Scalar late_{};           // periods, from taking the newest sample until the force of the next period has ended
  Scalar most_travel_m_{};  // of the motor, with what it may go on until the pulse can end
  Scalar direction_ = 1;
  std::int32_t most_steps_ = 0;
  std::int32_t pulse_steps_ = 0;
  std::int32_t still_ = 0;
  std::int32_t overdue_in_ = 0;
  std::int16_t given_ = 0;
  std::int16_t blind_ = 0;
  std::uint8_t pulse_periods_ = 1;
  std::uint8_t left_ = 0;
  std::uint8_t latency_ = 0;
  std::uint8_t swings_ = 0;    // of the force, from more than all of it one way to more than all of it the other
  std::int8_t last_full_ = 0;  // the way of the last that was too much
  Phase phase_ = Phase::free;
  bool anchored_ = false;
  bool starts_ = false;
  bool pulse_starts_ = false;
  bool pulsed_ = false;
};

}  // namespace breakaway::law
