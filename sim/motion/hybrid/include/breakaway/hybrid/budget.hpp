// Budget: the work that one run may cost before it is refused by name. Work is counted and never timed, so that the
// same run is refused on every computer and at every load.
#pragma once

#include <limits>
#include <string>

namespace breakaway::hybrid {

class Budget {
 public:
  // Multiplications: a few seconds on a PC.
  static constexpr double usual_work = 4e9;
  static constexpr double judgements = 64;  // in all the work

  // `work`: multiplications, above 0.
  explicit Budget(double work = usual_work) : work_{work} {}

  // Counts the work of one step of a search or of one event; a step is what a refusal is told in.
  void spend(double work) {
    spent_ += work;
    ++steps_;
  }

  // Says whether the work is used up, or judge() has found that it will not do.
  bool exhausted() const { return spent_ > work_ || hopeless_; }

  // A run that would cost many times its work is given up early. judge() carries the pace of late on over `slow_s`, how
  // long the motion may go on as it does now, of the `left_s` that are left; infinity is not judged. It begins with an
  // eighth of the work and asks for four times the work, later for twice, and it does not believe in a pace that rises.
  // The last one is due when the work is used up.
  bool judgement_due() const { return spent_ >= next_judgement_; }
  void judge(double left_s, double slow_s);
  // Says whether it has judged before: only then does rub() matter.
  bool judged() const { return judged_ > 0; }
  // Counts what friction takes, in any unit of energy: it falls in time as the vibrations do that friction brakes, and
  // vibrations that it will end soon are waited for, too.
  void rub(double energy) { rubbed_ += energy; }

  double spent() const { return spent_; }
  double share() const { return spent_ / work_; }  // of the work: 1 when it is exhausted
  double steps() const { return steps_; }

  // Throws RefusedForWork: "following this machine for 30 s would take about 4e+09 steps (cause): remedy". The number
  // is that of the steps so far, carried on at the same pace; `done_s` of `asked_s` are behind.
  [[noreturn]] void refuse(double done_s, double asked_s, const std::string& cause, const std::string& remedy,
                           const std::string& another_method = {}) const;

 private:
  double work_;
  double spent_ = 0;
  double steps_ = 0;
  bool hopeless_ = false;
  int judged_ = 0;  // times
  double next_judgement_ = work_ / judgements;
  double left_s_ = std::numeric_limits<double>::infinity();  // at the last judgement
  double pace_s_ = std::numeric_limits<double>::infinity();  // passed between the last two
  double rubbed_ = 0;                                        // since the last judgement
  double first_power_ = 0, first_left_s_ = 0;                // at the second judgement
};

}  // namespace breakaway::hybrid
