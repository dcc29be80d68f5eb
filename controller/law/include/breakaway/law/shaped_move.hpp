// ShapedMove: brings an axis whose load hangs on a spring near its target without making the load swing.
//
// The plan accelerates by +a for N periods, goes on for C, and by -a for N, which takes it a T^2 N (N + C) far. What is
// commanded is the mean of that over the last n periods, a whole period of the resonance: the mean of a swing over its
// period is nothing, so that what such a force starts it also ends. Friction is fed forward by the same mean. What
// friction does otherwise is mended by a feedback far slower than the resonance. Where the swing is sampled seldom,
// place and speed are read over spans in which it cancels.
//
// Kicks mend what the plan leaves; that its feedback does not drive the swing is certified (`swing_is_not_driven`).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "breakaway/law/control_types.hpp"
#include "breakaway/law/work_kicks.hpp"

namespace breakaway::law {

template <class Scalar>
class ShapedMove {
 public:
  static constexpr std::size_t most_periods = 63;  // over which readings are compared
  // Of speeding up and of constant speed together. What is further than they lead takes more than one approach.
  static constexpr std::int32_t most_planned_periods = 1'000'000;

  ShapedMove() noexcept = default;
  ShapedMove(const ShapedApproach<Scalar>& a, Scalar period_s, Scalar max_speed_m_s, std::uint8_t latency) noexcept
      : a_{&a}, period_s_{period_s}, max_speed_m_s_{max_speed_m_s} {
    set_share(1);
    place_late_s_ = (static_cast<Scalar>(latency) + static_cast<Scalar>(a.mean_periods) / 2) * period_s;
    speed_late_s_ = (static_cast<Scalar>(latency) + static_cast<Scalar>(a.speed_periods) / 2) * period_s;
    per_span_ = 1 / (static_cast<Scalar>(a.speed_periods) * period_s);
  }

  // The drive gives this share of the force that the plan was made for.
  void limit_force(Scalar share) noexcept { set_share(std::max(share, Scalar(1e-3))); }

  void restart() noexcept { primed_ = false; }
  void go_slowly() noexcept {}
  Scalar move_time_s(Scalar /*distance_m*/) const noexcept { return 0; }
  void take(Scalar /*time_s*/, Scalar /*distance_m*/) noexcept {}
  void set_off_at_once() noexcept {}
  bool began_in_motion() const noexcept { return false; }
  bool waits() const noexcept { return false; }
  void wait() noexcept {}
  void retarget(Scalar /*shift_m*/) noexcept { primed_ = false; }

  // Takes the newest position error and returns true when the plan is over. Where the reading is lost the axis is taken
  // to go on as it was seen to, and so does the plan: one that waited would be left behind by a period's way. Only a
  // reading ends it.
  bool see(Scalar x, Scalar /*force_N*/, Scalar /*command_N*/, Reading reading = Reading::there) noexcept {
    if (reading == Reading::lost) {
      skip();
      return false;
    }
    if (!primed_) {
      begin(x);
    } else {
      planning_ = false;
      if (seen_ < most_periods) ++seen_;
    }
    remember(x);
    return period_ >= end_;
  }

  // The force of the next period, unlimited. To be called once a period, after see() and unless that ended the plan.
  // The first period has work enough with the plan.
  Scalar force_N() noexcept {
    if (planning_) return 0;
    step_plan();
    const Scalar x = a_->mean_periods > 0 ? (read(0) + read(a_->mean_periods)) / 2 : newest_m_;
    const Scalar v = (newest_m_ - read(a_->speed_periods)) * per_span_;
    const Scalar place_m = place_m_ - speed_m_s_ * place_late_s_, speed_m_s = speed_m_s_ - gain_ * speed_late_s_;
    velocity_m_s_ = v;
    return a_->mass_kg * gain_ + friction_N_ + a_->stiffness_N_per_m * (place_m - x) +
           a_->damping_Ns_per_m * (speed_m_s - v);
  }

  bool reckons() const noexcept { return primed_; }
  bool turned_often() const noexcept { return false; }
  Scalar heading() const noexcept { return direction_; }
  Scalar velocity_m_s() const noexcept { return velocity_m_s_; }
  // Within so many friction stops an axis that the plan has led; and one that goes as fast as it may, where its target
  // moved to where it is, so that the plan had no time to brake it.
  Scalar braking_periods() const noexcept {
    return static_cast<Scalar>(end_) + a_->mass_kg * max_speed_m_s_ / (a_->friction_N * period_s_);
  }

 private:
  void set_share(Scalar share) noexcept {
    most_gain_m_ = std::min(a_->acceleration_m_s2 * share * period_s_, max_speed_m_s_) * period_s_;
    const Scalar most = max_speed_m_s_ / (a_->acceleration_m_s2 * share * period_s_);
    most_rising_ = most < Scalar(30000) ? std::max(static_cast<std::int32_t>(most), std::int32_t{1}) : 30000;
  }

  void skip() noexcept {
    if (!primed_) return;
    planning_ = false;
    if (seen_ < most_periods) ++seen_;
    remember(newest_m_ + velocity_m_s_ * period_s_);
  }

  void begin(Scalar x) noexcept {
    primed_ = true;
    direction_ = x > 0 ? Scalar{-1} : Scalar{1};
    const Scalar all_m = std::max(std::abs(x) - a_->short_of_target_m, Scalar{0});
    const Scalar ratio = all_m / most_gain_m_;
    rising_ = std::min(static_cast<std::int32_t>(std::sqrt(std::min(ratio, Scalar(1e9)))) + 1, most_rising_);
    const auto rising = static_cast<Scalar>(rising_);
    const Scalar both = std::min(ratio / rising, static_cast<Scalar>(most_planned_periods));  // N + C
    kept_ = std::max(static_cast<std::int32_t>(both) + 1 - rising_, std::int32_t{0});
    const Scalar distance_m = std::min(all_m, rising * static_cast<Scalar>(rising_ + kept_) * most_gain_m_);
    // Of the acceleration, in a period: one n-th enters or leaves the mean.
    step_ = direction_ * distance_m /
            (rising * static_cast<Scalar>(rising_ + kept_) * period_s_ * period_s_ *
             static_cast<Scalar>(a_->swing_periods));
    friction_step_N_ = direction_ * a_->friction_N / static_cast<Scalar>(a_->swing_periods);
    period_ = 0;
    end_ = 2 * rising_ + kept_ + a_->swing_periods;
    place_m_ = x;
    rounded_m_ = speed_m_s_ = gain_ = friction_N_ = velocity_m_s_ = 0;
    newest_ = seen_ = 0;
    planning_ = true;
  }

  // Which way the plan accelerates in its period k, and whether it moves.
  std::int32_t sense(std::int32_t k) const noexcept {
    if (k < 0) return 0;
    if (k < rising_) return 1;
    if (k < rising_ + kept_) return 0;
    return k < 2 * rising_ + kept_ ? -1 : 0;
  }
  std::int32_t moves(std::int32_t k) const noexcept { return k >= 0 && k < 2 * rising_ + kept_ ? 1 : 0; }

  void step_plan() noexcept {
    const std::int32_t gone = period_ - a_->swing_periods;
    gain_ += static_cast<Scalar>(sense(period_) - sense(gone)) * step_;
    friction_N_ += static_cast<Scalar>(moves(period_) - moves(gone)) * friction_step_N_;
    // The reference at the middle of the period that begins.
    const Scalar step_m = (speed_m_s_ + gain_ * period_s_ / 2) * period_s_ - rounded_m_, before_m = place_m_;
    place_m_ += step_m;
    rounded_m_ = (place_m_ - before_m) - step_m;
    speed_m_s_ += gain_ * period_s_;
    ++period_;
  }

  void remember(Scalar x) noexcept {
    newest_m_ = x;
    newest_ = newest_ > 0 ? newest_ - 1 : most_periods;
    readings_[newest_] = x;
  }
  // An axis rests when its approach begins.
  Scalar read(std::size_t periods_ago) const noexcept {
    const std::size_t index = newest_ + std::min(periods_ago, seen_);
    return readings_[index < readings_.size() ? index : index - readings_.size()];
  }

  const ShapedApproach<Scalar>* a_ = nullptr;
  Scalar period_s_{};
  Scalar max_speed_m_s_{};
  Scalar most_gain_m_{};  // a T^2
  Scalar place_late_s_{}, speed_late_s_{}, per_span_{};
  Scalar direction_ = 1;
  Scalar step_{}, friction_step_N_{};
  Scalar place_m_{}, speed_m_s_{}, gain_{}, friction_N_{};  // of the plan
  Scalar rounded_m_{};                                      // that the place is too far on, for its last digit
  Scalar newest_m_{}, velocity_m_s_{};
  std::array<Scalar, most_periods + 1> readings_{};
  std::size_t newest_ = 0;
  std::size_t seen_ = 0;  // readings before the newest since the approach began
  std::int32_t most_rising_ = 1;
  std::int32_t rising_ = 1, kept_ = 0, period_ = 0, end_ = 0;
  bool primed_ = false;
  bool planning_ = false;
};

}  // namespace breakaway::law
