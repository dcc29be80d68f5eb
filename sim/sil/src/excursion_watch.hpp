// ExcursionWatch: how far an axis went past its target, and how fast, at the ends of the periods.
#pragma once

#include <algorithm>
#include <cmath>

#include "breakaway/sil/result.hpp"

namespace breakaway::sil {

class ExcursionWatch {
 public:
  // The target is where the error is 0 now.
  void start_move(double error_m) {
    towards_ = direction_to_target(error_m);
    kick_towards_ = 0;
  }
  void start_kick(double error_m) { kick_towards_ = direction_to_target(error_m); }

  void look(double position_m, double error_m, double velocity_m_s) {
    figures_.lowest_m = std::min(figures_.lowest_m, position_m);
    figures_.highest_m = std::max(figures_.highest_m, position_m);
    figures_.overshoot_m = std::max(figures_.overshoot_m, error_m * towards_);
    figures_.beyond_m = std::max(figures_.beyond_m, error_m * kick_towards_);
    figures_.peak_speed_m_s = std::max(figures_.peak_speed_m_s, std::abs(velocity_m_s));
  }

  const Excursions& figures() const { return figures_; }

 private:
  static double direction_to_target(double error_m) { return error_m > 0 ? -1 : error_m < 0 ? 1 : 0; }

  Excursions figures_;
  double towards_ = 0;       // 0: it began on the target
  double kick_towards_ = 0;  // 0: no kick yet
};

}  // namespace breakaway::sil
