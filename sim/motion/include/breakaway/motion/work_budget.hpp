// WorkBudget: the work that one run may cost before it is refused by name. Work is counted in evaluations of the forces
// on what moves and never timed, so that the same run is refused on every computer and at every load.
//
// All that moves in a run shares one budget. A run whose end is known is given up early: with a share w of the work
// spent and a share t of the time behind, as soon as w > 1/8 and w^2 > t. So a first eighth is forgiven a pace of eight
// times the budget, and the last a pace of once.
#pragma once

#include <algorithm>
#include <string>

#include "breakaway/input/input_error.hpp"

namespace breakaway::motion {

// The run costs more than its budget: one line with cause, estimated cost and remedy.
class OverBudget : public InputError {
 public:
  using InputError::InputError;
};

class WorkBudget {
 public:
  // A few seconds of a PC, and more for a run of many periods.
  static constexpr double usual_work = 3e7, work_of_a_period = 1e3;

  struct Run {
    double duration_s;         // counted from time 0
    double periods = 0;        // of its controller
    bool may_end = true;       // before its duration is over, at rest
    double work = usual_work;  // beside that of the periods
  };

  // `what` moves, as "the axis"; `cause`: what makes it costly, and `remedy`: what a user can do about it.
  WorkBudget(const Run& run, std::string what, std::string cause, std::string remedy);

  // Throws OverBudget when the run, which has come to time_s, is to be refused.
  void spend(double time_s, double work) {
    spent_ += work;
    if (spent_ >= next_look_) look(time_s);
  }
  double left() const { return std::max(work_ - spent_, 0.0); }
  double spent() const { return spent_; }
  double share() const { return spent_ / work_; }  // of the work: 1 when it is used up
  [[noreturn]] void refuse(double time_s) const;

 private:
  void look(double time_s);

  Run run_;
  std::string what_, cause_, remedy_;
  double work_;
  double spent_ = 0;
  double next_look_;
};

}  // namespace breakaway::motion
