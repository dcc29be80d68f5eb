#include "breakaway/hybrid/budget.hpp"

#include <cmath>

#include "breakaway/hybrid/refused.hpp"

namespace breakaway::hybrid {

void Budget::refuse(double done_s, double asked_s, const std::string& cause, const std::string& remedy) const {
  const double total = steps_ * (asked_s / done_s);
  const std::string amount = std::isfinite(total) ? "about " + shown(total) : "more than " + shown(steps_);
  const std::string length = std::isfinite(asked_s) ? "for " + shown(asked_s) + " s" : "to its rest";
  throw Refused{"following this machine " + length + " would take " + amount + " steps (" + cause + ")", remedy};
}

}  // namespace breakaway::hybrid
