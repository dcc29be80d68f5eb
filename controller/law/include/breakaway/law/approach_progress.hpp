// ApproachProgress: tells an approach that hardly gets on from one that is slow at first.
//
// Friction that brakes an axis as hard, in a period, as the plan lets it gain speed leaves it creeping. A heavy one is
// as slow at first, as is a move whose jerk is limited, but gets on further in each span of periods than in the one
// before. One whose target moved behind it has to turn round first, and is where it was in between: spans begin anew
// for as long as it moves away.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "breakaway/law/braked_kicks.hpp"

namespace breakaway::law {

template <class Scalar>
class ApproachProgress {
 public:
  void restart() noexcept {
    periods_ = 0;
    last_way_m_ = -1;  // the first span says nothing yet
  }

  // To be called once a period of an approach that does not move away, with the newest position error.
  bool hardly_gets_on(Scalar x, const BrakedKicks<Scalar>& kicks, Scalar max_speed_m_s, Scalar period_s) noexcept {
    if (periods_ == 0) mark_m_ = x;
    if (++periods_ < kicks.patient_periods) return false;
    periods_ = 0;
    const Scalar speed_m_s = std::min(kicks.approach.switch_speed_m_s, max_speed_m_s) / 64;
    const Scalar way_m = std::abs(x - mark_m_);
    const bool gains = way_m > last_way_m_;
    last_way_m_ = way_m;
    return !gains && way_m < speed_m_s * period_s * static_cast<Scalar>(kicks.patient_periods);
  }

 private:
  Scalar mark_m_{};         // where the approach was when this span began,
  Scalar last_way_m_ = -1;  // and how far it had come in the one before; -1: there was none
  std::int32_t periods_ = 0;
};

}  // namespace breakaway::law
