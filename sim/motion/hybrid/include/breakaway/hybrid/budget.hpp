// Budget: the work that one run may cost before it is refused by name. Work is counted and never timed, so that the
// same run is refused on every computer and at every load.
#pragma once

#include <string>

namespace breakaway::hybrid {

class Budget {
 public:
  // Multiplications: a few seconds on a PC.
  static constexpr double usual_work = 4e9;

  // `work`: multiplications, above 0.
  explicit Budget(double work = usual_work) : work_{work} {}

  // Counts the work of one step of a search or of one event; a step is what a refusal is told in.
  void spend(double work) {
    spent_ += work;
    ++steps_;
  }

  bool exhausted() const { return spent_ > work_; }
  double share() const { return spent_ / work_; }  // of the work: 1 when it is exhausted
  double steps() const { return steps_; }

  // Throws Refused: "following this machine for 30 s would take about 4e+09 steps (cause): remedy". The number is
  // that of the steps so far, carried on at the same pace; `done_s` of `asked_s` are behind.
  [[noreturn]] void refuse(double done_s, double asked_s, const std::string& cause, const std::string& remedy) const;

 private:
  double work_;
  double spent_ = 0;
  double steps_ = 0;
};

}  // namespace breakaway::hybrid
