// CommandedForce: tells whether the force that a drive reports is one that it was commanded.
//
// A drive that keeps an old torque, adds an offset of its own (60B2h) or scales the target by something else gives
// force that nobody asked for. What it may report is bounded from the commands alone: by their hull with zero, which
// holds the newest two, because commands may swing to and fro from one period to the next, as those of an approach at
// its greatest speed do, and be reported a period late. Its borders fall back to the newest command with a time
// constant of 16 periods, or of twice that of the slowest current loop that the axis may have. The answer of a loop of
// first order never leaves the hull, because each of its steps goes a part of the way to the command and the border
// goes a smaller one. One that comes d periods late does, for less than 2 d samples, and so does noise, for as long as
// it lasts: so the force is wrong when ten fresh samples in a row lie beyond the hull by more than a twentieth of the
// axis' limit and a step of the report.
//
// Less force than commanded is no danger at once, but an axis that gets it is not the one that its law was designed
// for: a drive counts the target in another torque than was thought, or cannot give what was asked for. What it must
// give by now lies between the borders of the same hull without zero. The force is short when both are on one side of
// zero, and ten fresh samples in a row show less than three quarters of the nearer one, by the same tolerance. A drive
// that reports no force at all may have nothing to measure it with.
#pragma once

#include <algorithm>
#include <cmath>

namespace breakaway::firmware {

template <class Scalar>
class CommandedForce {
 public:
  static constexpr int patience = 10;  // fresh samples in a row

  // max_force_N: the axis' limit; infinite where nothing is to be watched. slow_lag, in [0, 1): the share of a change
  // of force that is left after a period behind the slowest current loop.
  constexpr explicit CommandedForce(Scalar max_force_N, Scalar slow_lag = 0) noexcept
      : tolerance_N_{max_force_N / 20}, fall_{std::min(Scalar{1} / 16, (1 - slow_lag) / 2)} {}

  // The axis starts from rest without force.
  void restart() noexcept { lowest_N_ = highest_N_ = least_N_ = most_N_ = before_N_ = Scalar{0}, beyond_ = short_ = 0; }

  // Takes the command of a period; what is not a number is zero force.
  void command(Scalar force_N) noexcept {
    const Scalar told_N = std::isnan(force_N) ? Scalar{0} : force_N;
    highest_N_ = std::max({told_N, before_N_, Scalar{0}, highest_N_ + (told_N - highest_N_) * fall_});
    lowest_N_ = std::min({told_N, before_N_, Scalar{0}, lowest_N_ + (told_N - lowest_N_) * fall_});
    least_N_ = std::min(told_N, least_N_ + (told_N - least_N_) * fall_);
    most_N_ = std::max(told_N, most_N_ + (told_N - most_N_) * fall_);
    before_N_ = told_N;
  }

  // Takes a fresh report; `step_N` is the least difference that it can show.
  void report(Scalar force_N, Scalar step_N) noexcept {
    const Scalar allowed_N = tolerance_N_ + step_N;
    const bool inside = force_N <= highest_N_ + allowed_N && force_N >= lowest_N_ - allowed_N;
    beyond_ = inside ? 0 : std::min(beyond_ + 1, patience);
    const bool lacks =
        is_short(force_N, least_N_, step_N, allowed_N) || is_short(-force_N, -most_N_, step_N, allowed_N);
    short_ = lacks ? std::min(short_ + 1, patience) : 0;
  }

  bool exceeded() const noexcept { return beyond_ == patience; }
  bool fallen_short() const noexcept { return short_ == patience; }

 private:
  static bool is_short(Scalar given_N, Scalar owed_N, Scalar step_N, Scalar allowed_N) noexcept {
    return given_N > step_N && given_N < Scalar(0.75) * owed_N - allowed_N;
  }

  Scalar tolerance_N_;
  Scalar fall_;  // share of the way to the newest command that a border goes in a period
  Scalar lowest_N_{0}, highest_N_{0};
  Scalar least_N_{0}, most_N_{0};  // that the drive gives by now
  Scalar before_N_{0};             // the newest command
  int beyond_ = 0, short_ = 0;
};

}  // namespace breakaway::firmware
