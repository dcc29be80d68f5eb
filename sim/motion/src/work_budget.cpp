#include "breakaway/motion/work_budget.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

namespace breakaway::motion {
namespace {

constexpr double looks = 64;  // in all the work
constexpr double forgiven_share = 0.125;

std::string shown(const char* format, double number) {
  char text[32];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

}  // namespace

WorkBudget::WorkBudget(const Run& run, std::string what, std::string cause, std::string remedy)
    : run_{run},
      what_{std::move(what)},
      cause_{std::move(cause)},
      remedy_{std::move(remedy)},
      work_{run.work + run.periods * work_of_a_period},
      next_look_{work_ / looks} {}

void WorkBudget::look(double time_s) {
  next_look_ = std::min(spent_ + work_ / looks, work_);
  const bool hopeless = !run_.may_end && share() > forgiven_share && share() * share() > time_s / run_.duration_s;
  if (share() >= 1 || hopeless) refuse(time_s);
}

void WorkBudget::refuse(double time_s) const {
  const double times = time_s > 0 ? run_.duration_s / time_s : 0;  // at the pace so far
  const bool known = std::isfinite(times) && times * share() >= 1;
  const std::string amount = known ? "about " + shown("%.2g", times * spent_) : "more than " + shown("%.2g", spent_);
  throw OverBudget{"following " + what_ + " for " + shown("%g", run_.duration_s) + " s would take " + amount +
                   " evaluations of its forces, and a run may take " + shown("%.2g", work_) + " (" + cause_ +
                   "): " + remedy_};
}

}  // namespace breakaway::motion
