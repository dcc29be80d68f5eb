// ApproachProgress: tells an approach that hardly gets on from one that is slow at first.
//
// Friction that brakes an axis as hard, in a period, as the plan lets it gain speed leaves it creeping. A heavy one is
// as slow at first, as is a move whose jerk is limited, but gets on further in each span of periods than in the one
// before. So does one whose target moved behind it, where ways count as they lead towards the target or away from it.
// That is asked of readings: the speed that a plan reckons with changes its sign from period to period on an axis that
// sticks and slips.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "breakaway/law/braked_kicks.hpp"

namespace breakaway::law {

template <class Scalar>
class ApproachProgress {
 public:
  ApproachProgress() noexcept = default;
  ApproachProgress(const BrakedKicks<Scalar>& kicks, Scalar max_speed_m_s, Scalar period_s) noexcept
      : slow_m_{std::min(kicks.approach.switch_speed_m_s, max_speed_m_s) / 64 * period_s *
                static_cast<Scalar>(kicks.patient_periods)},
        span_periods_{kicks.patient_periods} {}

  // The first span says nothing yet.
  void restart() noexcept {
    periods_ = 0;
    last_side_ = 0;
  }

  // The target moved on.
  void shift_origin(Scalar shift_m) noexcept { mark(mark_m_ - shift_m); }

  // To be called once a period of an approach, with the newest position error.
  bool hardly_gets_on(Scalar x) noexcept {
    if (periods_ == 0) mark(x);
    if (++periods_ < span_periods_) return false;
    periods_ = 0;
    const Scalar way_m = (mark_m_ - x) * side_;
    const bool gains = side_ != last_side_ || way_m > last_way_m_;
    last_side_ = side_;
    last_way_m_ = way_m;
    return !gains && std::abs(way_m) < slow_m_;
  }

 private:
  void mark(Scalar x) noexcept {
    mark_m_ = x;
    side_ = x < 0 ? Scalar{-1} : Scalar{1};
  }

  Scalar slow_m_{};      // that a span leads on at least
  Scalar mark_m_{};      // where the approach was when this span began,
  Scalar side_ = 1;      // on this side of the target,
  Scalar last_way_m_{};  // and how far it had come in the one before,
  Scalar last_side_{};   // which began on this side of the target; 0: there was none
  std::int32_t span_periods_ = 1;
  std::int32_t periods_ = 0;
};

}  // namespace breakaway::law
