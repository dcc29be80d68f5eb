#include "breakaway/hybrid/budget.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "breakaway/hybrid/refused.hpp"

namespace breakaway::hybrid {

void Budget::judge(double left_s, double slow_s) {
  const double passed_s = left_s_ - left_s, before_s = pace_s_, power = rubbed_ / passed_s;
  left_s_ = left_s;
  pace_s_ = passed_s;
  rubbed_ = 0;
  next_judgement_ = std::min(spent_ + work_ / judgements, work_);
  if (!(left_s < std::numeric_limits<double>::infinity())) return;
  if (++judged_ == 2) {
    first_power_ = power;
    first_left_s_ = left_s + passed_s / 2;
  }
  if (judged_ < judgements / 8) return;
  // Friction of a constant force brakes a vibration at a constant rate.
  const double lost = first_power_ - power, lost_in_s = first_left_s_ - (left_s + passed_s / 2);
  if (lost > 0) slow_s = std::min(slow_s, power / lost * lost_in_s);
  // In units of the work: 4 where an eighth of it is spent, and 2 from a quarter on.
  const double cost = slow_s / passed_s / judgements, most = std::max(2.0, 0.5 / share());
  hopeless_ = passed_s <= 2 * before_s && cost > most;
}

void Budget::refuse(double done_s, double asked_s, const std::string& cause, const std::string& remedy,
                    const std::string& another_method) const {
  const double total = steps_ * (asked_s / done_s);
  const std::string amount = std::isfinite(total) ? "about " + shown(total) : "more than " + shown(steps_);
  const std::string length = std::isfinite(asked_s) ? "for " + shown(asked_s) + " s" : "to its rest";
  throw RefusedForWork{"following this machine " + length + " would take " + amount + " steps (" + cause + ")", remedy,
                       another_method};
}

}  // namespace breakaway::hybrid
