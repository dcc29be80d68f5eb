// CommandedForce: tells whether the force that a drive reports is one that it was commanded.
//
// A drive that keeps an old torque, adds an offset of its own (60B2h) or scales the target by something else gives
// force that nobody asked for. What it may report is bounded from the commands alone: by their hull with zero, whose
// borders fall back to the newest command with a time constant of 16 periods. The answer of a current loop of first
// order that is no slower than that never leaves the hull, because each of its steps goes a part of the way to the
// command and the border goes a smaller one. A delay and noise do leave it, for as long as they last: so the force is
// wrong when ten fresh samples in a row lie beyond the hull by more than a twentieth of the axis' limit and a step of
// the report. Less force than commanded is no danger, and is not looked at.
#pragma once

#include <algorithm>
#include <cmath>

namespace breakaway::firmware {

template <class Scalar>
class CommandedForce {
 public:
  static constexpr int patience = 10;  // fresh samples in a row

  // max_force_N: the axis' limit; infinite where nothing is to be watched.
  constexpr explicit CommandedForce(Scalar max_force_N) noexcept : tolerance_N_{max_force_N / 20} {}

  // The axis starts from rest without force.
  void restart() noexcept { lowest_N_ = highest_N_ = Scalar{0}, beyond_ = 0; }

  // Takes the command of a period; what is not a number is zero force.
  void command(Scalar force_N) noexcept {
    const Scalar told_N = std::isnan(force_N) ? Scalar{0} : force_N;
    highest_N_ = std::max({told_N, Scalar{0}, highest_N_ + (told_N - highest_N_) / 16});
    lowest_N_ = std::min({told_N, Scalar{0}, lowest_N_ + (told_N - lowest_N_) / 16});
  }

  // Takes a fresh report; `step_N` is the least difference that it can show.
  void report(Scalar force_N, Scalar step_N) noexcept {
    const Scalar allowed_N = tolerance_N_ + step_N;
    const bool inside = force_N <= highest_N_ + allowed_N && force_N >= lowest_N_ - allowed_N;
    beyond_ = inside ? 0 : std::min(beyond_ + 1, patience);
  }

  bool exceeded() const noexcept { return beyond_ == patience; }

 private:
  Scalar tolerance_N_;
  Scalar lowest_N_{0}, highest_N_{0};
  int beyond_ = 0;
};

}  // namespace breakaway::firmware
